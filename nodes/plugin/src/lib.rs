//! Placeholder until the first commit of code.
/// x
pub fn h() -> u32 {
    isophote::hello()
}
