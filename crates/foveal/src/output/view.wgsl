// The G-buffer made visible.

#import shared/frame.wgsl
#import shared/full_screen.wgsl
#import shared/hash.wgsl
#import shared/layers.wgsl
#import shared/places.wgsl
#import shared/surface.wgsl

// Which: 1 depth, 2 normals, 3 base colour, 4 instances, 5 motion, 6 materials.
override VIEW: u32 = 1u;

@group(1) @binding(0) var gbuffer_surface: texture_2d_array<u32>;
@group(1) @binding(1) var gbuffer_identity: texture_2d_array<u32>;
@group(1) @binding(2) var gbuffer_depth: texture_depth_2d_array;

// Of each instance.
#ifdef TABLES
@group(1) @binding(3) var place_table: texture_2d<u32>;
#else
@group(1) @binding(3) var<storage, read> places: array<Place>;
#endif

@fragment
fn view(@builtin(position) position: vec4f) -> @location(0) vec4f {
    let texel = vec2u(position.xy);
    let depth = load_depth(gbuffer_depth, texel);
    let identity = load_words(gbuffer_identity, texel).xy;
    if depth == 0.0 && VIEW != 5u {
        return vec4f(0.0, 0.0, 0.0, 1.0);
    }
    let surface = unpack_surface(load_words(gbuffer_surface, texel), vec3f(0.0));
    switch VIEW {
        case 1u: {
            // One grey step per 1/16 of a doubling: white at the near plane, black 16 doublings (65
            // km at 1 m) on.
            let doublings = log2(max(view_distance(depth), frame.near) / frame.near);
            return vec4f(vec3f(1.0 - saturate(doublings / 16.0)), 1.0);
        }
        case 2u: {
            return vec4f(surface.normal * 0.5 + 0.5, 1.0);
        }
        case 3u: {
            // Square roots are close to sRGB; the exact curve would only recode them.
            let encoded = unpack4x8unorm(load_words(gbuffer_surface, texel).x).rgb;
            return vec4f(encoded, 1.0);
        }
        case 4u, 6u: {
            var number = identity.x;
            if VIEW == 6u {
                number = place_of(identity.x - 1u).material + 1u;
            }
            let h = hash(number);
            return vec4f(0.25 + 0.75 * unpack4x8unorm(h).rgb, 1.0);
        }
        default: {
            let motion = select(unpack2x16float(identity.y), vec2f(0.0), identity.x == 0u);
            return vec4f(saturate(vec3f(motion / 32.0, 0.0) + 0.5), 1.0);
        }
    }
}
