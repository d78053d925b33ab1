//! Any bytes given as a NumPy array of excitations: rows of finite numbers, or an error.

#![no_main]

use libfuzzer_sys::fuzz_target;
use msk_runtime::inspect::Excitations;

/// Numbers of a row.
const WIDTH: usize = 2;

fuzz_target!(|bytes: &[u8]| match Excitations::from_npy(bytes, WIDTH) {
    Ok(read) => {
        assert!(read.rows() * WIDTH * 8 <= bytes.len());
        assert!((0..read.rows()).all(|row| read.row(row).len() == WIDTH && read.row(row).iter().all(|x| x.is_finite())));
    }
    Err(error) => assert!(error.to_string().len() < 1000),
});
