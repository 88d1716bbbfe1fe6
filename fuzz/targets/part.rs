#![no_main]

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| contrapposto_fuzz::part(bytes));
