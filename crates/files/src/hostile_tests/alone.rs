//! Memory of a test, in a process of its own.

/// Runs a test of a module in a process of its own: the address space is the whole process's, with what tests beside it take.
pub(super) fn alone(module: &str, name: &str, test: impl FnOnce()) {
    const ALONE: &str = "FRFID_TEST_ALONE";
    if std::env::var_os(ALONE).is_some() {
        return test();
    }
    let (_, module) = module.split_once("::").expect("a crate");
    let path = format!("{module}::{name}");
    let tests = std::env::current_exe().expect("this program");
    let mut itself = std::process::Command::new(tests);
    let answer = itself.args(["--exact", &path]).env(ALONE, "1").output();
    let answer = answer.expect("run");
    let said = String::from_utf8_lossy(&answer.stdout);
    assert!(
        answer.status.success() && said.contains("1 passed"),
        "{said}"
    );
}

/// The address space of this process in bytes; `None` where the system does not say.
pub(super) fn address_space() -> Option<u64> {
    let status = std::fs::read_to_string("/proc/self/status").ok()?;
    let peak = status
        .lines()
        .find_map(|line| line.strip_prefix("VmPeak:"))?;
    Some(1024 * peak.trim().trim_end_matches(" kB").parse::<u64>().ok()?)
}
