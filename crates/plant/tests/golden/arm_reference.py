"""Golden numbers of two arms by Pinocchio (pip install pin), an independent multibody code.

The Manutec r3 (the tables of its description, wrist locked) and an arm of six moving bodies drawn at random: offsets, joint
orientations, axes, centres of mass, full inertia tensors, a locked body in the middle, a payload, gravity askew.

python arm_reference.py > arm_reference.json    # every array row by row; Pinocchio 4.1.0, numpy
"""

import json

import numpy as np
import pinocchio as pin

DEG = np.pi / 180


def build(bodies, payload):
    """Pinocchio's model of bodies (dicts with the names of frfid's fields); locked joints become fixed placements."""
    model = pin.Model()
    parent, placement = 0, pin.SE3.Identity()
    for body in bodies:
        here = placement * pin.SE3(np.array(body["rotation"]), np.array(body["offset_m"]))
        axis = np.array(body["axis"]) / np.linalg.norm(body["axis"])
        if "position_rad" in body:
            placement = here * pin.SE3(pin.AngleAxis(body["position_rad"], axis).toRotationMatrix(), np.zeros(3))
        else:
            joint = pin.JointModelRevoluteUnaligned(axis)
            parent, placement = model.addJoint(parent, joint, here, body["name"]), pin.SE3.Identity()
        append(model, parent, body, placement)
    append(model, parent, payload, placement)
    return model


def append(model, joint, body, placement):
    inertia = pin.Inertia(body["mass_kg"], np.array(body["center_of_mass_m"]), np.array(body["inertia_kg_m2"]))
    model.appendBodyToJoint(joint, inertia, placement)


def states(model, gravity, rng, count, pose=None):
    model.gravity.linear = np.array(gravity)
    data = model.createData()
    rows = []
    for n in range(count):
        q = np.array(pose) if pose is not None and n == 0 else rng.uniform(-np.pi, np.pi, model.nq)
        v, torque = rng.normal(0, 2, model.nv), rng.normal(0, 300, model.nv)
        mass = pin.crba(model, data, q).copy()
        mass = np.triu(mass) + np.triu(mass, 1).T
        rows.append(
            {
                "position_rad": q.tolist(),
                "velocity_rad_s": v.tolist(),
                "torque_nm": torque.tolist(),
                "mass_kg_m2": mass.ravel().tolist(),
                "gravity_nm": pin.computeGeneralizedGravity(model, data, q).tolist(),
                "bias_nm": pin.nonLinearEffects(model, data, q, v).tolist(),
                "acceleration_rad_s2": pin.aba(model, data, q, v, torque).tolist(),
                "gravity_gradient_nm_per_rad": pin.computeGeneralizedGravityDerivatives(model, data, q).ravel().tolist(),
            }
        )
    return rows


def manutec_r3():
    eye = np.eye(3).tolist()

    def body(name, axis, offset, mass, com, inertia, locked=None):
        xx, yy, zz, xy = inertia
        tensor = [[xx, xy, 0], [xy, yy, 0], [0, 0, zz]]
        fields = {"name": name, "axis": axis, "offset_m": offset, "rotation": eye, "mass_kg": mass}
        fields |= {"center_of_mass_m": com, "inertia_kg_m2": tensor}
        return fields if locked is None else fields | {"position_rad": locked * DEG}

    x, y, o = [1, 0, 0], [0, 1, 0], [0, 0, 0]
    bodies = [
        body("b1", y, [0, 0.351, 0], 1, o, (0, 1.16, 0, 0)),
        body("b2", x, [0, 0.324, 0.3], 56.5, [0.172, 0.205, 0], (2.58, 0.64, 2.73, -0.46)),
        body("b3", x, [0, 0.65, 0], 26.4, [0.064, -0.034, 0], (0.279, 0.245, 0.413, -0.070)),
        body("b4", y, [0, 0.414, -0.155], 28.7, o, (1.67, 0.081, 1.67, 0), locked=0),
        body("b5", x, [0, 0.186, 0], 5.2, o, (1.25, 0.81, 1.53, 0), locked=-110),
        body("b6", y, [0, 0.125, 0], 0.5, [0.05, 0.05, 0.05], (0, 0, 0, 0), locked=0),
    ]
    payload = {"mass_kg": 15, "center_of_mass_m": [0.1, 0.25, 0.1], "inertia_kg_m2": np.zeros((3, 3)).tolist()}
    return bodies, payload


def rotation(rng):
    q, _ = np.linalg.qr(rng.normal(size=(3, 3)))
    return q * np.linalg.det(q)


def drawn(rng, name):
    """A body with a sound inertia tensor: that of masses at random places."""
    points = rng.normal(0, 0.2, (6, 3))
    points -= points.mean(axis=0)
    tensor = sum(p @ p * np.eye(3) - np.outer(p, p) for p in points) * rng.uniform(1, 5)
    fields = {"name": name, "axis": rng.normal(size=3).tolist(), "offset_m": rng.normal(0, 0.3, 3).tolist()}
    fields |= {"rotation": rotation(rng).tolist(), "mass_kg": rng.uniform(1, 20)}
    return fields | {"center_of_mass_m": rng.normal(0, 0.2, 3).tolist(), "inertia_kg_m2": tensor.tolist()}


def main():
    rng = np.random.default_rng(3)
    bodies, payload = manutec_r3()
    pose = np.array([-60, 20, 90]) * DEG
    r3 = states(build(bodies, payload), [0, -9.81, 0], rng, 4, pose)
    bodies = [drawn(rng, f"link{i}") for i in range(7)]
    bodies[2] |= {"axis": [0, 0, -2.0]}
    bodies[3] |= {"position_rad": 0.7}
    bodies[4] |= {"axis": [0, 0, 1.0], "rotation": np.eye(3).tolist()}
    payload = drawn(rng, "payload")
    gravity = [2.0, -3.0, -9.0]
    drawn_states = states(build(bodies, payload), gravity, rng, 4)
    six = {"bodies": bodies, "payload": payload, "gravity_m_s2": gravity, "states": drawn_states}
    print(json.dumps({"manutec_r3": r3, "six": six}, indent=1))


if __name__ == "__main__":
    main()
