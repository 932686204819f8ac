//! Placeholder until the first commit of code.
/// x
pub fn hello() -> u32 {
    3
}
