//! Size of a dataset as it is declared, against the bytes of it that are in the file.

use hdf5_pure::{Dataset, Layout};

use crate::budget::most_of;
use crate::log::mat::level73::told;
use crate::run::header::MOST_VALUES;

/// How many elements a dataset has; refuses more than the file can hold.
pub(super) fn check_stored(dataset: &Dataset, path: &str, size: u64) -> Result<usize, String> {
    let shape = dataset.shape().map_err(told)?;
    let count = shape
        .iter()
        .try_fold(1_u64, |n, length| n.checked_mul(*length));
    let width = dataset.element_size().map_err(told)?;
    let declared = count.and_then(|count| count.checked_mul(width));
    let (Some(count), Some(declared)) = (count, declared) else {
        return Err(format!("{path} has sides {shape:?}"));
    };
    let stored = stored(dataset, size)?;
    let unpacked = match dataset.filters()[..] {
        [] => stored,
        _ => most_of(stored),
    };
    if count > MOST_VALUES as u64 || declared > unpacked {
        return Err(format!(
            "{path} has {count} numbers, {declared} bytes, of which {stored} are in the file"
        ));
    }
    usize::try_from(count).map_err(told)
}

/// Bytes of a dataset in a file of so many.
fn stored(dataset: &Dataset, size: u64) -> Result<u64, String> {
    let within = |address: u64, length: u64| {
        let end = address.saturating_add(length);
        if end <= size { length } else { 0 }
    };
    let stored = match dataset.layout().map_err(told)? {
        Layout::Compact { size } => size,
        Layout::Contiguous {
            address: Some(address),
            size,
        } => within(address, size),
        Layout::Chunked { .. } => {
            let chunks = dataset.chunks().map_err(told)?.into_iter();
            let lengths = chunks.map(|chunk| within(chunk.address, chunk.storage_size));
            lengths.fold(0, u64::saturating_add)
        }
        _ => 0,
    };
    // chunks may lie on one another
    Ok(stored.min(size))
}
