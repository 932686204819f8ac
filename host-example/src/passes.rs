//! One pass of a plan: the kernel, and what it binds.

use crate::kernels::{Kernel, Kernels, mistaken};
use crate::textures::Slot;
use crate::uniforms::Uniforms;
use isophote_files::error::{Error, Result};
use isophote_loader::plan::Pass;
use isophote_loader::uniforms::{Block, Bytes};

/// Pass that can be recorded once it is bound.
#[derive(Debug)]
pub struct ReadyPass {
    kernel: Kernel,
    /// Place of the grid's bytes.
    pub grid: Block,
    /// Place of the parameters' bytes, if the kernel has any.
    pub params: Option<Block>,
    /// Indices of the textures read and written.
    pub textures: Vec<u32>,
    workgroups: [u32; 3],
    /// None until all textures are there; one for all frames, or as many as take turns.
    pub groups: Vec<wgpu::BindGroup>,
}

impl ReadyPass {
    /// A pass whose uniform bytes have the next places in `uniforms`.
    pub fn new(kernel: Kernel, pass: &Pass<'_>, uniforms: &mut Bytes) -> Self {
        Self {
            kernel,
            grid: uniforms.place(pass.grid),
            params: Some(pass.params).filter(|p| !p.is_empty()).map(|params| uniforms.place(params)),
            textures: pass.inputs.iter().chain(pass.outputs).copied().collect(),
            workgroups: pass.workgroups,
            groups: Vec::new(),
        }
    }

    /// Makes the bind groups: one, or as many as textures of the pass take turns.
    ///
    /// # Errors
    /// [`Error::Failure`] when a texture is missing or the device refuses.
    pub fn bind(&mut self, kernels: &Kernels, uniforms: &Uniforms, textures: &[Slot]) -> Result<()> {
        let slots = self.textures.iter().filter_map(|index| textures.get(*index as usize));
        let turns = slots.map(|slot| slot.views.len()).max().unwrap_or(1);
        for turn in 0..turns {
            self.groups.push(kernels.make(|| self.group(kernels, uniforms, textures, turn))?);
        }
        Ok(())
    }

    fn group(
        &self,
        kernels: &Kernels,
        uniforms: &Uniforms,
        textures: &[Slot],
        turn: usize,
    ) -> Result<wgpu::BindGroup> {
        let blocks = [(0, self.grid)].into_iter().chain(self.params.map(|block| (1, block)));
        let mut entries: Vec<wgpu::BindGroupEntry<'_>> = blocks
            .map(|(binding, block)| wgpu::BindGroupEntry { binding, resource: uniforms.binding(block) })
            .collect();
        for (binding, index) in (2..).zip(&self.textures) {
            let slot = textures.get(*index as usize).ok_or_else(unbound)?;
            let view = slot.views.get(turn).or(slot.views.first()).ok_or_else(unbound)?;
            entries
                .push(wgpu::BindGroupEntry { binding, resource: wgpu::BindingResource::TextureView(view) });
        }
        if let Some(binding) = self.kernel.sampler {
            let resource = wgpu::BindingResource::Sampler(kernels.sampler());
            entries.push(wgpu::BindGroupEntry { binding, resource });
        }
        Ok(kernels.device().create_bind_group(&wgpu::BindGroupDescriptor {
            label: Some("pass of a plan"),
            layout: &self.kernel.layout,
            entries: &entries,
        }))
    }

    /// Records it with the bind group of a turn.
    ///
    /// # Errors
    /// [`Error::Failure`] when it is not bound.
    pub fn encode(&self, compute: &mut wgpu::ComputePass<'_>, turn: usize) -> Result<()> {
        let group = self.groups.get(turn).ok_or_else(unbound)?;
        let [x, y, z] = self.workgroups;
        compute.set_pipeline(&self.kernel.pipeline);
        compute.set_bind_group(0, group, &[]);
        compute.dispatch_workgroups(x, y, z);
        Ok(())
    }
}

/// The error of a pass whose textures nobody has bound.
pub fn unbound() -> Error {
    mistaken("a pass is to be recorded before its textures are bound".into())
}
