//! The program's window: input to the editor, the editor's frames to the screen.

#[cfg(test)]
#[cfg(target_os = "linux")]
mod tests;

use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::time::{Duration, Instant};

use egui::ViewportId;
use egui_wgpu::{RendererOptions, ScreenDescriptor};
use egui_winit::accesskit_winit;
use orogeny_engine::{Gpu, Settings, WindowGpu, window_gpu};
use winit::application::ApplicationHandler;
use winit::dpi::LogicalSize;
use winit::event::WindowEvent;
use winit::event_loop::{ActiveEventLoop, ControlFlow, EventLoop, EventLoopProxy};
use winit::window::{Window, WindowId};

use crate::editor::{Editor, EditorOptions};
use crate::{Error, Result};

/// How large the window is at first, in points.
const FIRST_SIZE: LogicalSize<f64> = LogicalSize::new(1440.0, 900.0);
/// The longest that is waited between two looks at what happened.
const LONGEST_WAIT: Duration = Duration::from_millis(500);

/// Something happened outside of the window.
#[derive(Debug)]
enum Happened {
    /// On another thread: there is something new to be shown.
    News,
    /// To those who read the window aloud, or press its buttons for someone.
    Assistance(accesskit_winit::Event),
}

impl From<accesskit_winit::Event> for Happened {
    fn from(event: accesskit_winit::Event) -> Self {
        Self::Assistance(event)
    }
}

/// Opens the window with a terrain, or for `None` with the one that was open last; returns when it was closed.
///
/// # Errors
/// [`Error::Window`] when there is no screen; [`Error::Engine`] when nothing can draw in it.
pub fn run(options: EditorOptions, file: Option<PathBuf>) -> Result<()> {
    let events = EventLoop::<Happened>::with_user_event().build().map_err(|err| no_window(&err))?;
    let proxy = events.create_proxy();
    let mut program = Program { start: Some((options, file)), proxy, shown: None, failure: None };
    events.run_app(&mut program).map_err(|err| no_window(&err))?;
    program.failure.map_or(Ok(()), Err)
}

fn no_window(err: &dyn std::fmt::Display) -> Error {
    Error::Window { detail: err.to_string() }
}

struct Program {
    /// Until there is a window.
    start: Option<(EditorOptions, Option<PathBuf>)>,
    proxy: EventLoopProxy<Happened>,
    shown: Option<Shown>,
    /// What ended it.
    failure: Option<Error>,
}

/// A window with what is shown in it.
struct Shown {
    window: Arc<Window>,
    editor: Editor,
    input: egui_winit::State,
    screen: Screen,
    /// How many devices there have been.
    num_devices: u32,
    /// When the next frame is wanted, if nothing happens before.
    next_frame: Option<Instant>,
}

/// What draws in the window.
struct Screen {
    gpu: Gpu,
    surface: wgpu::Surface<'static>,
    configuration: wgpu::SurfaceConfiguration,
    painter: egui_wgpu::Renderer,
}

impl Screen {
    fn new(window: &Arc<Window>, settings: &Settings) -> Result<Self> {
        let WindowGpu { gpu, adapter, surface } = window_gpu(settings, Arc::clone(window))?;
        let capabilities = surface.get_capabilities(&adapter);
        // Colours of the interface are given as the screen shows them.
        let is_plain = |format: &&wgpu::TextureFormat| {
            matches!(format, wgpu::TextureFormat::Bgra8Unorm | wgpu::TextureFormat::Rgba8Unorm)
        };
        let format = capabilities.formats.iter().find(is_plain).or(capabilities.formats.first());
        let format = *format.ok_or_else(|| no_window(&"its surface takes no pictures"))?;
        let size = window.inner_size();
        let configuration = surface
            .get_default_config(&adapter, size.width.max(1), size.height.max(1))
            .ok_or_else(|| no_window(&"the adapter does not draw in it"))?;
        let configuration = wgpu::SurfaceConfiguration {
            format,
            present_mode: wgpu::PresentMode::AutoVsync,
            ..configuration
        };
        surface.configure(gpu.device(), &configuration);
        let painter = egui_wgpu::Renderer::new(gpu.device(), format, RendererOptions::default());
        Ok(Self { gpu, surface, configuration, painter })
    }

    fn resize(&mut self, width: u32, height: u32) {
        if width > 0 && height > 0 {
            (self.configuration.width, self.configuration.height) = (width, height);
            self.surface.configure(self.gpu.device(), &self.configuration);
        }
    }

    /// Makes pictures of the ground known to egui; tells whether one is shown for the first time.
    fn take_pictures(&mut self, editor: &mut Editor) -> bool {
        let (device, filter) = (self.gpu.device(), wgpu::FilterMode::Linear);
        let painter = &mut self.painter;
        editor.take_pictures(|view, known| match known {
            Some(picture) => {
                painter.update_egui_texture_from_wgpu_texture(device, view, filter, picture);
                picture
            }
            None => painter.register_native_texture(device, view, filter),
        })
    }

    /// Shows shapes; textures that they need are taken over first, and those that no shape needs any more are dropped.
    fn paint(
        &mut self,
        mut textures: egui::TexturesDelta,
        shapes: &[egui::ClippedPrimitive],
        pixels_per_point: f32,
    ) {
        for (id, deltas) in textures.set.drain() {
            for delta in &deltas {
                self.painter.update_texture(self.gpu.device(), self.gpu.queue(), id, delta);
            }
        }
        self.present(shapes, pixels_per_point);
        for id in textures.free.drain() {
            self.painter.free_texture(&id);
        }
    }

    fn present(&mut self, shapes: &[egui::ClippedPrimitive], pixels_per_point: f32) {
        let frame = match self.surface.get_current_texture() {
            wgpu::CurrentSurfaceTexture::Success(frame) | wgpu::CurrentSurfaceTexture::Suboptimal(frame) => {
                frame
            }
            wgpu::CurrentSurfaceTexture::Outdated | wgpu::CurrentSurfaceTexture::Lost => {
                self.surface.configure(self.gpu.device(), &self.configuration);
                return;
            }
            _ => return,
        };
        let view = frame.texture.create_view(&wgpu::TextureViewDescriptor::default());
        let screen = ScreenDescriptor {
            size_in_pixels: [self.configuration.width, self.configuration.height],
            pixels_per_point,
        };
        let mut encoder = self
            .gpu
            .device()
            .create_command_encoder(&wgpu::CommandEncoderDescriptor { label: Some("orogeny.window") });
        let (device, queue) = (self.gpu.device(), self.gpu.queue());
        let before = self.painter.update_buffers(device, queue, &mut encoder, shapes, &screen);
        {
            let pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
                label: Some("orogeny.window"),
                color_attachments: &[Some(wgpu::RenderPassColorAttachment {
                    view: &view,
                    depth_slice: None,
                    resolve_target: None,
                    ops: wgpu::Operations {
                        load: wgpu::LoadOp::Clear(wgpu::Color::BLACK),
                        store: wgpu::StoreOp::Store,
                    },
                })],
                ..wgpu::RenderPassDescriptor::default()
            });
            self.painter.render(&mut pass.forget_lifetime(), shapes, &screen);
        }
        queue.submit(before.into_iter().chain([encoder.finish()]));
        queue.present(frame);
    }
}

impl Shown {
    fn new(
        events: &ActiveEventLoop,
        options: EditorOptions,
        file: Option<&Path>,
        proxy: EventLoopProxy<Happened>,
    ) -> Result<Self> {
        // Assistance has to be there before the window is seen.
        let attributes = Window::default_attributes()
            .with_title("Orogeny")
            .with_inner_size(FIRST_SIZE)
            .with_visible(false);
        let window = Arc::new(events.create_window(attributes).map_err(|err| no_window(&err))?);
        let screen = Screen::new(&window, &options.settings)?;
        let input = new_input(events, &window, &screen.gpu, proxy.clone());
        window.set_visible(true);
        // An event loop that has ended wakes no one.
        let of_editor = proxy.clone();
        let wake = move || _ = of_editor.send_event(Happened::News).ok();
        let mut editor = Editor::new(options, screen.gpu.clone(), wake);
        match file {
            Some(file) => editor.open(file),
            None => editor.open_last(),
        }
        window.request_redraw();
        Ok(Self { window, editor, input, screen, num_devices: 1, next_frame: None })
    }

    fn draw(&mut self) {
        let start = Instant::now();
        self.editor.update();
        let input = self.input.take_egui_input(&self.window);
        let ctx = self.input.egui_ctx().clone();
        let output = ctx.run_ui(input, |ui| self.editor.ui(ui));
        self.input.handle_platform_output(&self.window, output.platform_output);
        let is_picture_first = self.screen.take_pictures(&mut self.editor);
        let shapes = ctx.tessellate(output.shapes, output.pixels_per_point);
        self.screen.paint(output.textures_delta, &shapes, output.pixels_per_point);
        self.editor.take_left_pictures().iter().for_each(|picture| self.screen.painter.free_texture(picture));
        let is_finer_next = self.editor.note_frame(start.elapsed());
        let delay = output.viewport_output.get(&ViewportId::ROOT).map(|viewport| viewport.repaint_delay);
        if is_picture_first || is_finer_next || self.editor.wants_frame() {
            self.next_frame = Some(Instant::now());
        } else {
            self.next_frame = delay.and_then(|delay| Instant::now().checked_add(delay.min(LONGEST_WAIT)));
        }
        if let Err(err) = self.screen.gpu.check() {
            self.mend(&err);
        }
    }

    /// After the device was lost: another one, and all that was on it.
    fn mend(&mut self, err: &dyn std::fmt::Display) {
        self.editor.tell(err.to_string(), true);
        match Screen::new(&self.window, self.editor.settings()) {
            Ok(screen) => {
                self.editor.set_gpu(screen.gpu.clone());
                self.screen = screen;
                self.num_devices += 1;
                send_fonts_again(self.input.egui_ctx(), self.num_devices);
            }
            Err(err) => self.editor.tell(err.to_string(), true),
        }
        self.window.request_redraw();
    }

    /// Does for someone what assistance asks for.
    fn assist(&mut self, event: accesskit_winit::WindowEvent) {
        match event {
            accesskit_winit::WindowEvent::InitialTreeRequested => self.input.egui_ctx().enable_accesskit(),
            accesskit_winit::WindowEvent::ActionRequested(request) => {
                self.input.on_accesskit_action_request(request);
            }
            accesskit_winit::WindowEvent::AccessibilityDeactivated => {
                self.input.egui_ctx().disable_accesskit()
            }
        }
        self.window.request_redraw();
    }
}

/// A window's input, with an interface that has not drawn anything yet.
fn new_input(
    events: &ActiveEventLoop,
    window: &Window,
    gpu: &Gpu,
    proxy: EventLoopProxy<Happened>,
) -> egui_winit::State {
    let scale = Some(window.scale_factor() as f32);
    let max_side = Some(gpu.device().limits().max_texture_dimension_2d as usize);
    let ctx = egui::Context::default();
    let mut input = egui_winit::State::new(ctx, ViewportId::ROOT, window, scale, window.theme(), max_side);
    input.init_accesskit(events, window, proxy);
    input
}

/// Has letters drawn anew for another device. The interface itself stays: what reads it aloud can be tied to a window only before that is
/// seen. It takes fonts anew where they differ from those that it has, so one of them gets another name.
fn send_fonts_again(ctx: &egui::Context, num_devices: u32) {
    let mut fonts = egui::FontDefinitions::default();
    let letters = fonts.families.get(&egui::FontFamily::Proportional).cloned().unwrap_or_default();
    fonts.families.insert(egui::FontFamily::Name(format!("device {num_devices}").into()), letters);
    ctx.set_fonts(fonts);
}

impl ApplicationHandler<Happened> for Program {
    fn resumed(&mut self, events: &ActiveEventLoop) {
        let Some((options, file)) = self.start.take() else { return };
        match Shown::new(events, options, file.as_deref(), self.proxy.clone()) {
            Ok(shown) => self.shown = Some(shown),
            Err(err) => {
                self.failure = Some(err);
                events.exit();
            }
        }
    }

    fn user_event(&mut self, _events: &ActiveEventLoop, happened: Happened) {
        let Some(shown) = &mut self.shown else { return };
        match happened {
            Happened::News => shown.window.request_redraw(),
            Happened::Assistance(event) => shown.assist(event.window_event),
        }
    }

    fn window_event(&mut self, events: &ActiveEventLoop, _window: WindowId, event: WindowEvent) {
        let Some(shown) = &mut self.shown else { return };
        let response = shown.input.on_window_event(&shown.window, &event);
        if response.repaint {
            shown.window.request_redraw();
        }
        match event {
            WindowEvent::RedrawRequested => shown.draw(),
            WindowEvent::Resized(size) => shown.screen.resize(size.width, size.height),
            WindowEvent::CloseRequested => {
                shown.editor.request_close();
                shown.window.request_redraw();
            }
            _ => {}
        }
        if shown.editor.is_closing() {
            if let Err(err) = shown.editor.close() {
                self.failure = Some(err);
            }
            self.shown = None;
            events.exit();
        }
    }

    fn about_to_wait(&mut self, events: &ActiveEventLoop) {
        let Some(shown) = &mut self.shown else { return };
        match shown.next_frame {
            Some(at) if at <= Instant::now() => {
                shown.next_frame = None;
                shown.window.request_redraw();
                events.set_control_flow(ControlFlow::Wait);
            }
            Some(at) => events.set_control_flow(ControlFlow::WaitUntil(at)),
            None => events.set_control_flow(ControlFlow::Wait),
        }
    }
}
