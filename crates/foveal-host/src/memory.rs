//! Memory that has been freed, given back to the system.

/// Gives the system back what has been freed. The C library of Linux (glibc) keeps it for later
/// otherwise, and the program stays as large as it was while it read a scene. It takes milliseconds;
/// other systems need no call, and none is made there.
pub fn give_back() {
    #[cfg(all(target_os = "linux", target_env = "gnu"))]
    #[allow(unsafe_code, reason = "a function of the C library")]
    // SAFETY: it takes a number, may be called at any time from any thread, and touches only what
    // nobody holds.
    unsafe {
        libc::malloc_trim(0);
    }
}

#[cfg(all(test, target_os = "linux", target_env = "gnu"))]
mod tests {
    use super::*;
    use std::hint::black_box;

    /// Bytes of the program that are in memory.
    fn resident() -> usize {
        let pages = std::fs::read_to_string("/proc/self/statm").unwrap();
        pages.split(' ').nth(1).unwrap().parse::<usize>().unwrap() * 4096
    }

    #[test]
    fn what_has_been_freed_is_given_back() {
        // One list that stays at the end keeps the C library from giving the others back by itself.
        let mut lists: Vec<Vec<u8>> = (0..4096).map(|_| black_box(vec![1; 16 << 10])).collect();
        let last = lists.pop();
        let held = resident();
        drop(lists);
        give_back();
        let kept = resident();
        assert!(kept + (48 << 20) < held, "{held} to {kept} bytes");
        drop(last);
    }
}
