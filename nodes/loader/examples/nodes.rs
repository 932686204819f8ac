//! What the library can do: its nodes, each with its label and its group.

fn main() -> isophote_loader::Result<()> {
    let library = isophote_loader::Library::open()?;
    println!("Isophote {}", library.version());
    for node in library.catalogue()?.nodes {
        println!("{:28} {:28} {}", node.id, node.label, node.group);
    }
    Ok(())
}
