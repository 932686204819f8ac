//! Recording: barriers, uniforms, dispatches, and the blit to the host's image.

use super::device::Device;
use super::objects::WHOLE;
use super::passes::{Passes, Port};
use ash::vk::{self, AccessFlags as Access, PipelineStageFlags as Stage};

/// Most bytes that one command writes into a buffer.
const MOST_WRITTEN: usize = 65536;

/// Stages at which the library works, and what they do there.
const WORK: Stage = Stage::from_raw(Stage::COMPUTE_SHADER.as_raw() | Stage::TRANSFER.as_raw());
const USES: Access = Access::from_raw(
    Access::SHADER_READ.as_raw()
        | Access::SHADER_WRITE.as_raw()
        | Access::UNIFORM_READ.as_raw()
        | Access::TRANSFER_READ.as_raw()
        | Access::TRANSFER_WRITE.as_raw(),
);
const ALL: Access = Access::from_raw(Access::MEMORY_READ.as_raw() | Access::MEMORY_WRITE.as_raw());

/// A command buffer in the recording state.
#[derive(Clone, Copy)]
pub struct Recorder<'a> {
    /// The device.
    pub device: &'a Device,
    /// The command buffer, which is outside of a render pass.
    pub commands: vk::CommandBuffer,
}

impl Recorder<'_> {
    /// Records all passes with the bindings `bindings`, between barriers that order them with everything around.
    pub fn record(self, passes: &Passes, ports: &[Port], bindings: usize) {
        // What was in the intermediate images is not needed, and recordings know nothing of each other.
        let own = passes.own_images().map(|image| {
            transition(
                image,
                WHOLE,
                [vk::ImageLayout::UNDEFINED, vk::ImageLayout::GENERAL],
                [Access::empty(), USES],
            )
        });
        let enter =
            ports.iter().map(|p| (p, [p.given.before, p.layout])).filter(changes).map(|(p, layouts)| {
                transition(p.given.image, p.given.range, layouts, [Access::MEMORY_WRITE, USES])
            });
        let images: Vec<_> = own.chain(enter).collect();
        self.barrier([Stage::ALL_COMMANDS, WORK], [Access::MEMORY_WRITE, USES], &images);
        self.write_uniforms(passes);
        self.dispatch(passes, bindings);
        self.blit(ports);
        let leave =
            ports.iter().map(|p| (p, [p.layout, p.given.after])).filter(changes).map(|(p, layouts)| {
                transition(
                    p.given.image,
                    p.given.range,
                    layouts,
                    [Access::SHADER_WRITE | Access::TRANSFER_WRITE, ALL],
                )
            });
        let images: Vec<_> = leave.collect();
        let written = Access::SHADER_WRITE | Access::TRANSFER_WRITE;
        self.barrier([WORK, Stage::ALL_COMMANDS], [written, ALL], &images);
    }

    /// Uniforms go the way of commands, so that recordings in flight keep theirs.
    fn write_uniforms(self, passes: &Passes) {
        let (buffer, bytes) = passes.uniforms();
        for (index, part) in bytes.chunks(MOST_WRITTEN).enumerate() {
            let at = (index * MOST_WRITTEN) as u64;
            // SAFETY: the command buffer is in the recording state, and the bytes are as long as the buffer.
            unsafe { self.device.raw.cmd_update_buffer(self.commands, buffer, at, part) };
        }
        let stages = [Stage::TRANSFER, Stage::COMPUTE_SHADER];
        self.barrier(stages, [Access::TRANSFER_WRITE, Access::UNIFORM_READ], &[]);
    }

    fn dispatch(self, passes: &Passes, bindings: usize) {
        let point = vk::PipelineBindPoint::COMPUTE;
        let raw = &self.device.raw;
        for (pass, set) in passes.passes().iter().zip(passes.sets(bindings)) {
            if pass.waits {
                let used = Access::SHADER_READ | Access::SHADER_WRITE;
                self.barrier([Stage::COMPUTE_SHADER; 2], [Access::SHADER_WRITE, used], &[]);
            }
            let [x, y, z] = pass.workgroups;
            // SAFETY: the command buffer is in the recording state; the set is of the pipeline's layout.
            unsafe {
                raw.cmd_bind_pipeline(self.commands, point, pass.kernel.pipeline);
                raw.cmd_bind_descriptor_sets(self.commands, point, pass.kernel.layout, 0, &[*set], &[]);
                raw.cmd_dispatch(self.commands, x, y, z);
            }
        }
    }

    /// Converts results to the formats of the host's images.
    fn blit(self, ports: &[Port]) {
        let blits: Vec<_> = ports.iter().filter_map(|port| Some((port, port.blit_from?))).collect();
        if blits.is_empty() {
            return;
        }
        let stages = [Stage::COMPUTE_SHADER, Stage::TRANSFER];
        self.barrier(stages, [Access::SHADER_WRITE, Access::TRANSFER_READ], &[]);
        for (port, from) in blits {
            let [x, y] = port.size.map(u32::cast_signed);
            let corners = [vk::Offset3D::default(), vk::Offset3D { x, y, z: 1 }];
            let layers = |range: vk::ImageSubresourceRange| vk::ImageSubresourceLayers {
                aspect_mask: range.aspect_mask,
                mip_level: range.base_mip_level,
                base_array_layer: range.base_array_layer,
                layer_count: 1,
            };
            let region = vk::ImageBlit {
                src_subresource: layers(WHOLE),
                src_offsets: corners,
                dst_subresource: layers(port.given.range),
                dst_offsets: corners,
            };
            // SAFETY: the command buffer is in the recording state; both images are at least of this size.
            unsafe {
                self.device.raw.cmd_blit_image(
                    self.commands,
                    from,
                    vk::ImageLayout::GENERAL,
                    port.given.image,
                    port.layout,
                    &[region],
                    vk::Filter::NEAREST,
                );
            }
        }
    }

    /// Lets what comes after wait for what came before, and sees what it wrote.
    fn barrier(self, stages: [Stage; 2], access: [Access; 2], images: &[vk::ImageMemoryBarrier<'_>]) {
        let memory = [vk::MemoryBarrier::default().src_access_mask(access[0]).dst_access_mask(access[1])];
        let none = vk::DependencyFlags::empty();
        // SAFETY: the command buffer is in the recording state.
        unsafe {
            self.device.raw.cmd_pipeline_barrier(
                self.commands,
                stages[0],
                stages[1],
                none,
                &memory,
                &[],
                images,
            );
        }
    }
}

fn changes(entry: &(&Port, [vk::ImageLayout; 2])) -> bool {
    entry.1[0] != entry.1[1]
}

fn transition(
    image: vk::Image,
    range: vk::ImageSubresourceRange,
    layouts: [vk::ImageLayout; 2],
    access: [Access; 2],
) -> vk::ImageMemoryBarrier<'static> {
    vk::ImageMemoryBarrier::default()
        .src_access_mask(access[0])
        .dst_access_mask(access[1])
        .old_layout(layouts[0])
        .new_layout(layouts[1])
        .src_queue_family_index(vk::QUEUE_FAMILY_IGNORED)
        .dst_queue_family_index(vk::QUEUE_FAMILY_IGNORED)
        .image(image)
        .subresource_range(range)
}
