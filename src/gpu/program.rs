//! Compute shaders at work: inputs go to the card, passes run, one array of numbers comes back.

use std::sync::Arc;
use std::sync::mpsc;
use std::time::Duration;

use super::layout::{SIDE, source};
use super::{Gpu, GpuError};

/// Arrays that a shader reads.
pub(super) const INPUTS: usize = 3;

/// Longest wait for the card. One that takes longer has stopped, or is of no use.
pub(super) const PATIENCE: Duration = Duration::from_secs(2);

/// Least size of a buffer, bytes: none may be empty.
const LEAST_BYTES: u64 = 256;

/// One run of a [`Program`].
pub(super) struct Run<'a> {
    /// Bytes of the uniform.
    pub(super) uniform: &'a [u8],
    /// Bytes of the arrays that are read.
    pub(super) inputs: [&'a [u8]; INPUTS],
    /// How many numbers come back.
    pub(super) results: usize,
    /// Which entries run, one after the other, and over how many columns and rows.
    pub(super) passes: &'a [(usize, [usize; 2])],
}

/// The entries of one shader, and the buffers that they work on, which are kept from run to run.
///
/// Every shader has one uniform, [`INPUTS`] arrays to read, and one array of results to write, in that order.
#[derive(Debug)]
pub(super) struct Program {
    gpu: Arc<Gpu>,
    layout: wgpu::BindGroupLayout,
    entries: Vec<wgpu::ComputePipeline>,
    uniform: Store,
    inputs: [Store; INPUTS],
    results: Store,
    /// What the processor can read.
    back: Store,
    group: Option<wgpu::BindGroup>,
    pub(super) patience: Duration,
}

impl Program {
    /// The entries of the shader `name`.
    ///
    /// # Errors
    /// When the adapter does not compute, or refuses the shader.
    pub(super) fn new(gpu: &Arc<Gpu>, name: &'static str, entries: &[&str]) -> Result<Self, GpuError> {
        gpu.can_compute()?;
        let device = &gpu.device;
        let storage = |read_only| wgpu::BufferBindingType::Storage { read_only };
        let kinds = [
            wgpu::BufferBindingType::Uniform,
            storage(true),
            storage(true),
            storage(true),
            storage(false),
        ];
        let mut binding = 0;
        let bindings = kinds.map(|ty| {
            binding += 1;
            wgpu::BindGroupLayoutEntry {
                binding: binding - 1,
                visibility: wgpu::ShaderStages::COMPUTE,
                ty: wgpu::BindingType::Buffer {
                    ty,
                    has_dynamic_offset: false,
                    min_binding_size: None,
                },
                count: None,
            }
        });
        let layout = device.create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor {
            label: Some(name),
            entries: &bindings,
        });
        let module = device.create_shader_module(wgpu::ShaderModuleDescriptor {
            label: Some(name),
            source: wgpu::ShaderSource::Wgsl(source(name).into()),
        });
        let pipelines = device.create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
            label: Some(name),
            bind_group_layouts: &[Some(&layout)],
            ..wgpu::PipelineLayoutDescriptor::default()
        });
        let entries = entries
            .iter()
            .map(|entry| {
                device.create_compute_pipeline(&wgpu::ComputePipelineDescriptor {
                    label: Some(entry),
                    layout: Some(&pipelines),
                    module: &module,
                    entry_point: Some(entry),
                    compilation_options: wgpu::PipelineCompilationOptions::default(),
                    cache: None,
                })
            })
            .collect();
        gpu.sound()?;
        let read = wgpu::BufferUsages::STORAGE | wgpu::BufferUsages::COPY_DST;
        Ok(Self {
            layout,
            entries,
            uniform: Store::new(wgpu::BufferUsages::UNIFORM | wgpu::BufferUsages::COPY_DST),
            inputs: [(); INPUTS].map(|()| Store::new(read)),
            results: Store::new(wgpu::BufferUsages::STORAGE | wgpu::BufferUsages::COPY_SRC),
            back: Store::new(wgpu::BufferUsages::MAP_READ | wgpu::BufferUsages::COPY_DST),
            group: None,
            patience: PATIENCE,
            gpu: Arc::clone(gpu),
        })
    }

    /// Runs, and hands the results to `take`.
    ///
    /// # Errors
    /// When the card is lost, refuses something, or does not answer in time. Then nothing was handed over, and the program
    /// is of no more use.
    pub(super) fn run(&mut self, run: &Run<'_>, take: impl FnOnce(&[f32])) -> Result<(), GpuError> {
        // A card that was lost since the last run says so now.
        let _ = self.gpu.device.poll(wgpu::PollType::Poll);
        self.gpu.sound()?;
        let bytes = (run.results * size_of::<f32>()) as u64;
        self.fit(run, bytes)?;
        let (Some(group), Some(results), Some(back)) = (&self.group, &self.results.buffer, &self.back.buffer)
        else {
            return Err(GpuError::Refused("no buffers".to_owned()));
        };
        let mut encoder = self
            .gpu
            .device
            .create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
        for &(entry, [cols, rows]) in run.passes {
            let mut pass = encoder.begin_compute_pass(&wgpu::ComputePassDescriptor::default());
            pass.set_pipeline(&self.entries[entry]);
            pass.set_bind_group(0, group, &[]);
            pass.dispatch_workgroups(groups(cols), groups(rows), 1);
        }
        encoder.copy_buffer_to_buffer(results, 0, back, 0, bytes);
        let submission = self.gpu.queue.submit([encoder.finish()]);
        let (mapping, mapped) = mpsc::channel();
        back.map_async(wgpu::MapMode::Read, ..bytes, move |result| {
            // Nobody waits any more: then nobody misses it.
            let _ = mapping.send(result);
        });
        let refused = |why: &dyn std::fmt::Display| GpuError::Refused(why.to_string());
        self.gpu
            .device
            .poll(wgpu::PollType::Wait {
                submission_index: Some(submission),
                timeout: Some(self.patience),
            })
            .map_err(|error| refused(&error))?;
        self.gpu.sound()?;
        mapped
            .try_recv()
            .map_err(|error| refused(&error))?
            .map_err(|error| refused(&error))?;
        {
            let view = back.get_mapped_range(..bytes).map_err(|error| refused(&error))?;
            take(bytemuck::try_cast_slice(&view).map_err(|error| refused(&error))?);
        }
        back.unmap();
        Ok(())
    }

    /// Brings uniform and inputs to the card, into buffers that are made anew where they are too small.
    fn fit(&mut self, run: &Run<'_>, bytes: u64) -> Result<(), GpuError> {
        let limits = self.gpu.device.limits();
        let most = limits.max_buffer_size.min(limits.max_storage_buffer_binding_size);
        let inputs = run.inputs.iter().map(|input| input.len() as u64);
        let widest = run.passes.iter().flat_map(|(_, size)| size).copied().max();
        if inputs.chain([bytes]).any(|bytes| bytes > most)
            || groups(widest.unwrap_or(0)) > limits.max_compute_workgroups_per_dimension
        {
            return Err(GpuError::Refused(format!(
                "work of {} results is too large for it",
                run.results
            )));
        }
        let gpu = &self.gpu;
        let mut grown = self.uniform.fill(gpu, run.uniform);
        for (store, input) in self.inputs.iter_mut().zip(run.inputs) {
            grown |= store.fill(gpu, input);
        }
        grown |= self.results.fit(gpu, bytes);
        self.back.fit(gpu, bytes);
        if grown || self.group.is_none() {
            let stores = std::iter::once(&self.uniform)
                .chain(&self.inputs)
                .chain([&self.results]);
            let bound: Vec<wgpu::BindGroupEntry<'_>> = (0..)
                .zip(stores.filter_map(|store| store.buffer.as_ref()))
                .map(|(binding, buffer)| wgpu::BindGroupEntry {
                    binding,
                    resource: buffer.as_entire_binding(),
                })
                .collect();
            self.group = Some(gpu.device.create_bind_group(&wgpu::BindGroupDescriptor {
                label: None,
                layout: &self.layout,
                entries: &bound,
            }));
        }
        Ok(())
    }
}

/// Workgroups along a side of so many invocations.
fn groups(invocations: usize) -> u32 {
    invocations.div_ceil(SIDE as usize) as u32
}

/// A buffer on the card that grows and never shrinks.
#[derive(Debug)]
struct Store {
    usage: wgpu::BufferUsages,
    buffer: Option<wgpu::Buffer>,
}

impl Store {
    fn new(usage: wgpu::BufferUsages) -> Self {
        Self { usage, buffer: None }
    }

    /// Makes room for so many bytes. True where that took another buffer.
    fn fit(&mut self, gpu: &Gpu, bytes: u64) -> bool {
        if self.buffer.as_ref().is_some_and(|buffer| buffer.size() >= bytes) {
            return false;
        }
        self.buffer = Some(gpu.device.create_buffer(&wgpu::BufferDescriptor {
            label: None,
            // Room to grow, so that what changes its size all the time soon has its place.
            size: bytes.max(LEAST_BYTES).next_multiple_of(4) * 5 / 4 / 4 * 4,
            usage: self.usage,
            mapped_at_creation: false,
        }));
        true
    }

    /// Puts `bytes` into it. True where that took another buffer.
    fn fill(&mut self, gpu: &Gpu, bytes: &[u8]) -> bool {
        let grown = self.fit(gpu, bytes.len() as u64);
        if let Some(buffer) = &self.buffer {
            gpu.queue.write_buffer(buffer, 0, bytes);
        }
        grown
    }
}
