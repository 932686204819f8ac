//! Names of what is drawn.

use crate::model::Scene;

impl Scene {
    /// Names of the objects of all draws: those of a node and of what it hangs on, from the root, with slashes between them.
    /// A node without a name has that of its mesh, or its number.
    pub fn object_names(&self) -> Vec<String> {
        self.draws.iter().map(|draw| self.path(draw.node)).collect()
    }

    /// Names of the materials of all draws, or their numbers.
    pub fn material_names(&self) -> Vec<String> {
        let name = |index: usize| match self.materials[index].name.as_str() {
            "" => format!("material {index}"),
            name => name.to_owned(),
        };
        self.draws.iter().map(|draw| name(self.primitive(draw).material)).collect()
    }

    fn path(&self, index: usize) -> String {
        let node = &self.nodes[index];
        let mesh = node.mesh.map(|mesh| self.meshes[mesh].name.as_str()).unwrap_or_default();
        let own = match [node.name.as_str(), mesh].into_iter().find(|name| !name.is_empty()) {
            Some(name) => name.to_owned(),
            None => format!("node {index}"),
        };
        let above = std::iter::successors(node.parent, |parent| self.nodes[*parent].parent);
        let named = above.map(|parent| self.nodes[parent].name.as_str()).filter(|name| !name.is_empty());
        named.fold(own, |path, name| format!("{name}/{path}"))
    }
}

#[cfg(test)]
mod tests {
    use crate::{Material, Mesh, Node, Primitive, Scene, Vertex};

    #[test]
    fn things_have_the_names_of_what_they_hang_on() {
        let corners = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]];
        let vertices = corners.map(|position| Vertex { position, ..Vertex::default() }).to_vec();
        let mesh = |name: &str, material| Mesh {
            name: name.to_owned(),
            primitives: vec![Primitive {
                vertices: vertices.clone(),
                indices: vec![0, 1, 2],
                material,
                ..Primitive::default()
            }],
            weights: Vec::new(),
        };
        let meshes = vec![mesh("arm mesh", 0), mesh("", 1), mesh("", 0)];
        let skin = Material { name: "skin".to_owned(), ..Material::default() };
        let materials = vec![skin, Material::default()];
        let mut scene = Scene::assembled("x", meshes, &[], materials, vec![], vec![]).unwrap();
        let parents = [(Some(3), ""), (Some(0), "hand"), (None, "")];
        for (node, (parent, name)) in scene.nodes.iter_mut().zip(parents) {
            (node.parent, node.name) = (parent, name.to_owned());
        }
        scene.nodes.push(Node { parent: Some(4), name: "hero".to_owned(), ..Node::default() });
        // The one that a turned scene hangs on has no name.
        scene.nodes.push(Node::default());
        assert_eq!(scene.object_names(), ["hero/arm mesh", "hero/hand", "node 2"]);
        assert_eq!(scene.material_names(), ["skin", "material 1", "skin"]);
    }
}
