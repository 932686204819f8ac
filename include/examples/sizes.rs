//! Sizes in bytes that a host in another language can compare its structs with, and the version that they are of.

use isophote_abi::{ISOPHOTE_ABI_VERSION, IsophoteApi, IsophoteImage, IsophoteRequest};

fn main() {
    println!("version {ISOPHOTE_ABI_VERSION}");
    println!("IsophoteApi {}", size_of::<IsophoteApi>());
    println!("IsophoteImage {}", size_of::<IsophoteImage>());
    println!("IsophoteRequest {}", size_of::<IsophoteRequest>());
}
