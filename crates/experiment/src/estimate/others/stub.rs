use frfid_signals::Frf;
pub(super) struct Roughness {
    pub over_noise: f64,
    pub relative: f64,
}
pub(super) fn roughness(_: &Frf) -> Option<Roughness> {
    None
}
