//! Textures with their samplers: nearest texel, clamped to the edge, one level.

use super::Job;
use super::gpu::{Gpu, as_bytes};
use crate::LaneError;
use program::binding;
use program::texture::{Dimension, Texel, Texture};

/// The group of bindings of a kernel's textures, and its layout.
pub(super) struct Textures {
    pub layout: wgpu::BindGroupLayout,
    pub group: wgpu::BindGroup,
}

impl Textures {
    /// The textures of a kernel, for one stage; `None` for a kernel without any.
    pub fn new(gpu: &Gpu, job: &Job, stage: wgpu::ShaderStages) -> Result<Option<Self>, LaneError> {
        let textures = &job.textures;
        if textures.is_empty() {
            return Ok(None);
        }
        let binding = |handle| binding::of(&job.module, handle).ok_or_else(LaneError::unbound);
        let mut layouts = Vec::new();
        let mut views = Vec::new();
        let mut samplers = Vec::new();
        for texture in textures {
            let entry = |binding, ty| wgpu::BindGroupLayoutEntry { binding, visibility: stage, ty, count: None };
            layouts.push(entry(
                binding(texture.image)?,
                wgpu::BindingType::Texture {
                    sample_type: sample_type(texture.kind.texel),
                    view_dimension: view_dimension(texture)?,
                    multisampled: false,
                },
            ));
            views.push((binding(texture.image)?, view(gpu, texture)?));
            if let Some(sampler) = texture.sampler {
                let compares = texture.kind.texel == Texel::Depth;
                let kind = if compares {
                    wgpu::SamplerBindingType::Comparison
                } else {
                    wgpu::SamplerBindingType::NonFiltering
                };
                layouts.push(entry(binding(sampler)?, wgpu::BindingType::Sampler(kind)));
                samplers.push((binding(sampler)?, sampler_of(gpu, compares)));
            }
        }
        let layout =
            gpu.device.create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor { label: None, entries: &layouts });
        let views = views.iter().map(|(binding, view)| (*binding, wgpu::BindingResource::TextureView(view)));
        let samplers = samplers.iter().map(|(binding, sampler)| (*binding, wgpu::BindingResource::Sampler(sampler)));
        let entries: Vec<_> =
            views.chain(samplers).map(|(binding, resource)| wgpu::BindGroupEntry { binding, resource }).collect();
        let group = gpu.device.create_bind_group(&wgpu::BindGroupDescriptor {
            label: None,
            layout: &layout,
            entries: &entries,
        });
        Ok(Some(Self { layout, group }))
    }
}

fn sample_type(texel: Texel) -> wgpu::TextureSampleType {
    match texel {
        Texel::Float => wgpu::TextureSampleType::Float { filterable: false },
        Texel::Int => wgpu::TextureSampleType::Sint,
        Texel::Uint => wgpu::TextureSampleType::Uint,
        Texel::Depth => wgpu::TextureSampleType::Depth,
    }
}

fn view_dimension(texture: &Texture) -> Result<wgpu::TextureViewDimension, LaneError> {
    Ok(match (texture.kind.dimension, texture.kind.arrayed) {
        (Dimension::D1, false) => wgpu::TextureViewDimension::D1,
        (Dimension::D2, false) => wgpu::TextureViewDimension::D2,
        (Dimension::D2, true) => wgpu::TextureViewDimension::D2Array,
        (Dimension::D3, false) => wgpu::TextureViewDimension::D3,
        (Dimension::Cube, false) => wgpu::TextureViewDimension::Cube,
        (Dimension::Cube, true) => wgpu::TextureViewDimension::CubeArray,
        (Dimension::D1 | Dimension::D3, true) => {
            return Err(LaneError::Unsupported(format!("layers of `{}`", texture.name)));
        }
    })
}

fn sampler_of(gpu: &Gpu, compares: bool) -> wgpu::Sampler {
    gpu.device.create_sampler(&wgpu::SamplerDescriptor {
        compare: compares.then_some(wgpu::CompareFunction::LessEqual),
        ..wgpu::SamplerDescriptor::default()
    })
}

/// A texture with its contents.
fn view(gpu: &Gpu, texture: &Texture) -> Result<wgpu::TextureView, LaneError> {
    let [width, height, depth_or_array_layers] = texture.contents.size();
    let size = wgpu::Extent3d { width, height, depth_or_array_layers };
    let (format, texel_bytes) = match texture.kind.texel {
        Texel::Float => (wgpu::TextureFormat::Rgba32Float, 16),
        Texel::Int => (wgpu::TextureFormat::Rgba32Sint, 16),
        Texel::Uint => (wgpu::TextureFormat::Rgba32Uint, 16),
        Texel::Depth => (wgpu::TextureFormat::Depth16Unorm, 2),
    };
    let made = gpu.device.create_texture(&wgpu::TextureDescriptor {
        label: None,
        size,
        mip_level_count: 1,
        sample_count: 1,
        dimension: match texture.kind.dimension {
            Dimension::D1 => wgpu::TextureDimension::D1,
            Dimension::D2 | Dimension::Cube => wgpu::TextureDimension::D2,
            Dimension::D3 => wgpu::TextureDimension::D3,
        },
        format,
        usage: wgpu::TextureUsages::TEXTURE_BINDING | wgpu::TextureUsages::COPY_DST,
        view_formats: &[],
    });
    let depths;
    let bytes: &[u8] = if texture.kind.texel == Texel::Depth {
        depths = texture.contents.depths();
        bytemuck::cast_slice(&depths)
    } else {
        as_bytes(texture.contents.words())
    };
    let layout = wgpu::TexelCopyBufferLayout {
        offset: 0,
        bytes_per_row: Some(texel_bytes * width),
        rows_per_image: Some(height),
    };
    gpu.queue.write_texture(made.as_image_copy(), bytes, layout, size);
    Ok(made.create_view(&wgpu::TextureViewDescriptor {
        dimension: Some(view_dimension(texture)?),
        ..wgpu::TextureViewDescriptor::default()
    }))
}
