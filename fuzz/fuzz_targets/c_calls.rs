#![no_main]

libfuzzer_sys::fuzz_target!(|input: &[u8]| foveal_fuzz::c_calls(input));
