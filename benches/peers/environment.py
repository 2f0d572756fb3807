"""Environment of the peers: a virtual one below target/, with the packages of requirements.txt and the wheel of this checkout.

Nothing is done twice: what is installed stays while requirements.txt and the wheel are the same.
"""

import hashlib
import os
import pathlib
import subprocess
import sys
import venv

HERE = pathlib.Path(__file__).resolve().parent
ROOT = HERE.parents[1]
FOLDER = ROOT / "target" / "peers" / f"python{sys.version_info.major}.{sys.version_info.minor}"
SCRIPTS = FOLDER / ("Scripts" if os.name == "nt" else "bin")
PYTHON = SCRIPTS / ("python.exe" if os.name == "nt" else "python")


def prepare(wheel):
    """Makes the environment or brings it up to date, with this wheel or one built for it."""
    if sys.version_info < (3, 12):
        sys.exit("the peers need Python 3.12 or newer: python3.12 benches/peers")
    if not PYTHON.exists():
        print(f"a virtual environment: {FOLDER.relative_to(ROOT)}", flush=True)
        venv.create(FOLDER, with_pip=True)
    requirements = HERE / "requirements.txt"
    once(requirements, lambda: install_peers(requirements))
    wheel = wheel or build()
    once(wheel, lambda: install("--force-reinstall", "--no-deps", str(wheel), check=True))


def once(file, work):
    """Does the work unless it was done for a file of this content."""
    digest = hashlib.sha256(file.read_bytes()).hexdigest()
    done = FOLDER / f"{file.suffix[1:]}.done"
    if not done.exists() or done.read_text() != digest:
        done.unlink(missing_ok=True)
        work()
        done.write_text(digest)


def install_peers(requirements):
    """All packages together; where that fails one by one, and what cannot be had is named."""
    print("the packages of requirements.txt", flush=True)
    if install("-r", str(requirements)).returncode == 0:
        return
    for line in requirements.read_text().splitlines():
        if not line.startswith("#") and (failed := install(line)).returncode:
            print(f"LEFT OUT, cannot be installed: {line}\n{failed.stderr.strip()}", flush=True)


def install(*what, check=False):
    """pip install, quiet but for errors."""
    command = [PYTHON, "-m", "pip", "install", "--quiet", "--disable-pip-version-check", *what]
    done = subprocess.run(command, stderr=subprocess.PIPE, text=True)
    if check and done.returncode:
        sys.exit(done.stderr)
    return done


def build():
    """The wheel of this checkout in Cargo's release profile; Cargo builds what has changed."""
    print("the wheel: maturin build --release", flush=True)
    wheels = ROOT / "target" / "wheels"
    options = ["--release", "--locked", "--quiet", "--interpreter", PYTHON, "--out", wheels]
    subprocess.run([SCRIPTS / "maturin", "build", *options], cwd=ROOT, check=True)
    return max(wheels.glob("frfid-*.whl"), key=lambda path: path.stat().st_mtime)
