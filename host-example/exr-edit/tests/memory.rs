//! No file makes its reader allocate more than the limit says, whatever the file says.
//!
//! Allocations are counted on one thread, so everything runs on a pool of that thread alone.

mod support;

use std::cell::RefCell;

use isophote_exr_edit::{Channel, Edit, Error, File, Limits, PartEdit, Result, Sample};
use support::{assets, encodings, file, lossy};

/// Memory that does not follow from the file: messages of errors, the work lists of threads.
const SLACK: u64 = 64 << 10;

/// Reads every plane of every part, and writes the file with the first channel of each replaced and one added.
fn use_all(bytes: Vec<u8>, limits: Limits) -> Result<Vec<u8>> {
    let file = File::parse(bytes, limits)?;
    let mut changed = Vec::new();
    for (number, part) in file.parts().iter().enumerate() {
        let decoded = file.decode(number)?;
        for channel in 0..part.channels.len() {
            decoded.plane(channel)?;
        }
        let mut edit = Edit::of(part);
        let (first, pixels) = (&part.channels[0], part.window.width * part.window.height);
        edit.replace(&first.name, vec![0.5; pixels / (first.sampling.0 * first.sampling.1)])?;
        let name = "zz.added".to_owned();
        let added = Channel { name, sample: Sample::Half, flags: [0; 4], sampling: (1, 1) };
        edit.insert(added, vec![0.5; pixels])?;
        changed.push((decoded, edit));
    }
    let edits: Vec<PartEdit<'_>> = changed.iter().map(|(decoded, edit)| PartEdit { decoded, edit }).collect();
    let mut out = Vec::new();
    file.write(&edits, &mut out)?;
    Ok(out)
}

/// Only reads, and holds all planes of a part: nothing but what the limit bounds is allocated.
fn read_all(bytes: Vec<u8>, limits: Limits) -> Result<()> {
    let file = File::parse(bytes, limits)?;
    for (number, part) in file.parts().iter().enumerate() {
        let decoded = file.decode(number)?;
        let planes: Result<Vec<_>> = (0..part.channels.len()).map(|channel| decoded.plane(channel)).collect();
        planes?;
    }
    Ok(())
}

/// Most bytes that reading holds at once, beside the file, and how it ends.
fn peak(bytes: &[u8], memory: u64) -> (u64, Result<()>) {
    let result = RefCell::new(Ok(()));
    let counted = allocation_counter::measure(|| {
        *result.borrow_mut() = read_all(bytes.to_vec(), Limits { memory, ..Limits::default() });
    });
    (counted.bytes_max.saturating_sub(bytes.len() as u64), result.into_inner())
}

fn alone(run: impl FnOnce() + Send) {
    let pool = rayon::ThreadPoolBuilder::new().num_threads(1).use_current_thread().build();
    pool.expect("a pool of this thread").install(run);
}

/// Changes some bytes, the same ones for the same seed.
fn spoilt(bytes: &[u8], seed: u32) -> Vec<u8> {
    let mut spoilt = bytes.to_vec();
    let mut state = seed.wrapping_mul(2_654_435_761) | 1;
    let mut next = |below: usize| {
        state ^= state << 13;
        state ^= state >> 17;
        state ^= state << 5;
        state as usize % below
    };
    // Mostly in the header, where sizes are.
    let header = spoilt.len().min(400);
    for _ in 0..1 + seed % 4 {
        let at = if next(4) == 0 { next(spoilt.len()) } else { next(header) };
        spoilt[at] = [0, 1, 0x7f, 0x80, 0xff, next(256) as u8][next(6)];
    }
    if seed.is_multiple_of(7) {
        spoilt.truncate(next(bytes.len()));
    }
    spoilt
}

#[test]
fn reading_keeps_within_its_limit() {
    alone(|| {
        let (mut read, mut refused) = (0, 0);
        for encoding in encodings().into_iter().chain(lossy()) {
            let bytes = file(encoding, (96, 64), 1.0);
            for memory in [0, 1 << 10, 16 << 10, 256 << 10, 700 << 10, 1 << 20, 16 << 20] {
                let (used, result) = peak(&bytes, memory);
                assert!(used <= memory + SLACK, "{encoding:?}: {used} of {memory}");
                match result {
                    Ok(()) => {
                        // What is read is at least held decompressed and as planes; so it is counted.
                        assert!(used >= 2 * 96 * 64 * 14, "{encoding:?}: {used}");
                        read += 1;
                    }
                    Err(Error::Memory { limit, .. }) => {
                        assert_eq!(limit, memory);
                        refused += 1;
                    }
                    Err(other) => panic!("{encoding:?}: {other}"),
                }
            }
        }
        assert!(read >= 16 && refused >= 3 * 16, "{read} read, {refused} refused");
    });
}

#[test]
fn spoilt_files_keep_within_the_limit() {
    const LIMIT: u64 = 2 << 20;
    alone(|| {
        let mut refused = 0;
        for (index, encoding) in encodings().into_iter().chain(lossy()).enumerate() {
            let bytes = file(encoding, (40, 24), 1.0);
            for seed in 0..150 {
                let spoilt = spoilt(&bytes, seed * 31 + index as u32);
                let (used, result) = peak(&spoilt, LIMIT);
                assert!(used <= LIMIT + SLACK, "{encoding:?}, {seed}: {used}");
                refused += u32::from(result.is_err());
            }
        }
        assert!(refused > 500, "{refused}");
    });
}

#[test]
fn damaged_files_of_others_keep_within_the_limit() {
    const LIMIT: u64 = 8 << 20;
    alone(|| {
        for path in assets("Damaged") {
            let bytes = std::fs::read(&path).expect("the file can be read");
            let (used, _) = peak(&bytes, LIMIT);
            assert!(used <= LIMIT + SLACK, "{}: {used}", path.display());
            // And no limit makes them allocate what their length does not pay for.
            let (used, _) = peak(&bytes, 1 << 40);
            let most = 10_000 * bytes.len() as u64 + (16 << 20);
            assert!(used <= most, "{}: {used} for {} bytes", path.display(), bytes.len());
        }
    });
}

#[test]
fn a_bomb_is_refused_before_it_is_unpacked() {
    alone(|| {
        let zip = encodings()[3];
        let bomb = file(zip, (4096, 1024), 0.0);
        let unpacked = 4096 * 1024 * 14;
        assert!(bomb.len() < unpacked / 100, "{} bytes", bomb.len());
        let (used, result) = peak(&bomb, 4 << 20);
        assert!(used < 1 << 20, "{used}");
        assert!(matches!(result, Err(Error::Memory { .. })), "{result:?}");
        assert!(peak(&bomb, 1 << 30).1.is_ok());
    });
}

/// Place where the value of an attribute begins, behind its size.
fn value_of(bytes: &[u8], attribute: &str) -> usize {
    let name = format!("{attribute}\0");
    let at = bytes.windows(name.len()).position(|w| w == name.as_bytes()).expect("the attribute is there");
    let kind = at + name.len();
    kind + bytes[kind..].iter().position(|b| *b == 0).expect("its type ends") + 5
}

#[test]
fn sizes_that_the_file_cannot_pay_for_cost_nothing() {
    alone(|| {
        let scan = file(encodings()[3], (40, 24), 1.0);
        let tiled = file(encodings()[11], (40, 24), 1.0);
        let mut bad = Vec::new();
        let mut with = |bytes: &[u8], at: usize, value: &[u8]| {
            let mut changed = bytes.to_vec();
            changed[at..at + value.len()].copy_from_slice(value);
            bad.push(changed);
        };
        let window = |right: i32, bottom: i32| -> Vec<u8> {
            [0, 0, right, bottom].iter().flat_map(|v: &i32| v.to_le_bytes()).collect()
        };
        // Windows of many pixels.
        for (right, bottom) in
            [(65_535, 4095), (16_383, 16_383), (i32::MAX, i32::MAX), (39, 65_535), (65_535, 23)]
        {
            with(&scan, value_of(&scan, "dataWindow"), &window(right, bottom));
            with(&tiled, value_of(&tiled, "dataWindow"), &window(right, bottom));
        }
        // Tiles of one pixel, of none and of very many.
        for side in [0u32, 1, 1 << 20, u32::MAX] {
            with(&tiled, value_of(&tiled, "tiles"), &[side.to_le_bytes(), side.to_le_bytes()].concat());
        }
        // Attributes that are larger than the file.
        for attribute in ["channels", "compression", "name", "tiles"] {
            let bytes = if attribute == "tiles" { &tiled } else { &scan };
            for size in [u32::MAX, 1 << 30] {
                with(bytes, value_of(bytes, attribute) - 4, &size.to_le_bytes());
            }
        }
        for (index, bytes) in bad.iter().enumerate() {
            let (used, result) = peak(bytes, u64::MAX);
            assert!(result.is_err(), "file {index} reads");
            assert!(used < SLACK + 40 * bytes.len() as u64, "file {index}: {used}");
        }
    });
}

/// Sizes that a chunk of DWAA names are not believed.
#[test]
fn sizes_that_dwa_cannot_have_cost_nothing() {
    let bytes = file(lossy()[0], (64, 32), 0.0);
    let head = bytes.windows(17).position(|b| b == b"screenWindowWidth").expect("a header");
    // A chunk begins with its version, and sizes of 64 bits follow.
    let version = bytes[head..].windows(8).position(|b| b == 2u64.to_le_bytes()).expect("a chunk") + head;
    for place in [1, 6, 7, 8, 9] {
        for size in [1u64 << 20, 1 << 40, 1 << 62, u64::MAX] {
            let mut bytes = bytes.clone();
            bytes[version + 8 * place..][..8].copy_from_slice(&size.to_le_bytes());
            let (used, result) = peak(&bytes, 16 << 20);
            assert!(matches!(result, Err(Error::Damaged(_))), "{place}: {size}");
            assert!(used <= SLACK, "{place}: {size}: {used}");
        }
    }
}

#[test]
fn writing_keeps_to_the_limit_too() {
    alone(|| {
        for encoding in encodings().into_iter().chain(lossy()) {
            let bytes = file(encoding, (96, 64), 1.0);
            assert!(use_all(bytes.clone(), Limits::default()).is_ok(), "{encoding:?}");
            // The callers' planes and the file that is written are beside the limit.
            let pixels = 96 * 64;
            for memory in [64 << 10, 700 << 10, 2 << 20, 16 << 20] {
                let counted = allocation_counter::measure(|| {
                    let _ = use_all(bytes.clone(), Limits { memory, ..Limits::default() });
                });
                let most = memory + SLACK + 2 * pixels * 4 + 4 * bytes.len() as u64 + 3 * pixels * 16;
                assert!(counted.bytes_max <= most, "{encoding:?}: {} of {memory}", counted.bytes_max);
            }
        }
    });
}
