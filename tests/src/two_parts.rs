//! An EXR file of two parts, of which the second may be under any compression: its chunks are bytes that nobody reads.

/// Columns and rows of both parts.
pub const SIZE: (usize, usize) = (5, 300);

/// A file whose first part holds colour, not compressed, and whose second part holds a channel `Z` in chunks of `lines`
/// rows of the number `compression`. Returns the second part's chunks too.
pub fn file(compression: u8, lines: usize) -> (Vec<u8>, Vec<Vec<u8>>) {
    let (width, height) = SIZE;
    let row = |y: usize| (0..width * 3).flat_map(move |i| ((y + i) as f32 / 300.0).to_le_bytes()).collect();
    let color: Vec<Vec<u8>> = (0..height).map(row).collect();
    let other: Vec<Vec<u8>> =
        (0..height.div_ceil(lines)).map(|i| vec![compression ^ 0xa5 ^ i as u8; 7 + i]).collect();
    let parts =
        [("main", ["B", "G", "R"].as_slice(), 0, 1, &color), ("depth", &["Z"], compression, lines, &other)];
    let mut file = vec![0x76, 0x2f, 0x31, 0x01];
    file.extend(0x1002u32.to_le_bytes());
    for (name, channels, compression, _, chunks) in &parts {
        file.extend(header(name, channels, *compression, chunks.len()));
    }
    file.push(0);
    let count: usize = parts.iter().map(|part| part.4.len()).sum();
    let mut at = (file.len() + 8 * count) as u64;
    for chunk in parts.iter().flat_map(|part| part.4) {
        file.extend(at.to_le_bytes());
        at += 12 + chunk.len() as u64;
    }
    for (number, (.., lines, chunks)) in parts.iter().enumerate() {
        for (index, chunk) in chunks.iter().enumerate() {
            let head = [number as u32, (index * lines) as u32, chunk.len() as u32];
            file.extend(head.iter().flat_map(|v| v.to_le_bytes()));
            file.extend(chunk);
        }
    }
    (file, other)
}

fn header(name: &str, channels: &[&str], compression: u8, chunks: usize) -> Vec<u8> {
    let mut header = Vec::new();
    let mut attribute = |name: &str, kind: &str, value: &[u8]| {
        for text in [name, kind] {
            header.extend(text.as_bytes());
            header.push(0);
        }
        header.extend((value.len() as u32).to_le_bytes());
        header.extend(value);
    };
    let mut list = Vec::new();
    for channel in channels {
        list.extend(channel.as_bytes());
        list.push(0);
        // Floats, no flags, a sample for every pixel.
        list.extend([2u32, 0, 1, 1].iter().flat_map(|v| v.to_le_bytes()));
    }
    list.push(0);
    let window: Vec<u8> =
        [0, 0, SIZE.0 as i32 - 1, SIZE.1 as i32 - 1].iter().flat_map(|v| v.to_le_bytes()).collect();
    attribute("channels", "chlist", &list);
    attribute("chunkCount", "int", &(chunks as u32).to_le_bytes());
    attribute("compression", "compression", &[compression]);
    attribute("dataWindow", "box2i", &window);
    attribute("displayWindow", "box2i", &window);
    attribute("lineOrder", "lineOrder", &[0]);
    attribute("name", "string", name.as_bytes());
    attribute("pixelAspectRatio", "float", &1f32.to_le_bytes());
    attribute("screenWindowCenter", "v2f", &[0; 8]);
    attribute("screenWindowWidth", "float", &1f32.to_le_bytes());
    attribute("type", "string", b"scanlineimage");
    header.push(0);
    header
}
