//! The window as the stage draws it: pictures on the canvas, the pixels under the pointer, the controls.

use super::Stage;
use crate::drawing::canvas::{Arrangement, Reading, SURROUND, Shown};
use crate::drawing::shown::picture;
use crate::state::session::Session;
use isophote_render::layouts;

impl Stage {
    /// Draws canvas and controls; in a pass of their own where that is measured.
    pub(super) fn paint(
        &mut self,
        encoder: &mut wgpu::CommandEncoder,
        target: &wgpu::TextureView,
        session: &Session,
    ) {
        let size = self.screen.size();
        self.panel.prepare(&self.gpu.device, &self.gpu.queue, encoder, size);
        let grey = wgpu::Color { r: SURROUND.into(), g: SURROUND.into(), b: SURROUND.into(), a: 1.0 };
        let pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
            label: Some("window"),
            color_attachments: &[Some(layouts::cleared(target, grey))],
            ..Default::default()
        });
        let mut pass = pass.forget_lifetime();
        if self.sources.present().is_some() && !session.is_covered() {
            self.canvas.draw(&mut pass, session.viewport.area, size);
        }
        if let Some(clock) = &self.clock {
            drop(pass);
            let kept = wgpu::Operations { load: wgpu::LoadOp::Load, store: wgpu::StoreOp::Store };
            let own = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
                label: Some("controls"),
                color_attachments: &[Some(wgpu::RenderPassColorAttachment {
                    ops: kept,
                    ..layouts::cleared(target, grey)
                })],
                timestamp_writes: Some(clock.render(0)),
                ..Default::default()
            });
            self.panel.draw(&mut own.forget_lifetime(), size);
            clock.encode(encoder);
        } else {
            self.panel.draw(&mut pass, size);
        }
    }

    /// Places pictures on the canvas.
    pub(super) fn arrange(&mut self, session: &Session) {
        let Some(source) = self.sources.present() else { return };
        let viewport = &session.viewport;
        let places = viewport.places(session.nominal_size());
        let [left, right] = session.shown();
        let outputs = self.outputs(session);
        let pictures = [(left, places[0]), (right, places[1])].map(|(which, place)| {
            let (view, numbers) = picture(source, &outputs, viewport.overlay, which);
            Shown { view, numbers, place }
        });
        let arrangement = Arrangement {
            area: viewport.area,
            pictures,
            split: viewport.split(),
            exposure: viewport.exposure.exp2(),
            middle: session.open.scenery().map_or(1.0, |scenery| scenery.distance()),
            square: 8.0,
            reading: match viewport.is_difference() && left != right {
                true => Reading::Difference(viewport.amplification),
                false => Reading::Seen,
            },
        };
        self.canvas.set(&self.gpu.device, &self.gpu.queue, &arrangement);
    }

    /// Lets the pixels under the pointer be read.
    pub(super) fn encode_probe(&mut self, encoder: &mut wgpu::CommandEncoder, session: &Session) {
        let Some(source) = self.sources.present() else { return };
        let outputs = self.outputs(session);
        self.probe.encode(encoder, session, source, &outputs);
    }
}
