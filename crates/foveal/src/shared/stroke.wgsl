// Points and lines, widened on the screen. Rust: `scene/strokes.rs`; CPU twin:
// `forward/strokes_tests.rs`.

#import shared/frame.wgsl

// How far a place lies in front of the near plane; depth is reversed.
fn before_near(clip: vec4f) -> f32 {
    return clip.w - clip.z;
}

// How far along a line its end is cut by the near plane; 0 where it lies before it.
fn cut_at_near(end: vec4f, other: vec4f) -> f32 {
    let a = before_near(end);
    let b = before_near(other);
    let crosses = a < 0.0 && b > 0.0;
    return select(0.0, a / (a - b), crosses);
}

// The depth of a stroke, moved towards the eye by half its width in pixels and half a pixel: by so
// much a surface that the stroke lies on, seen at 45 degrees, is nearer at the stroke's border. Never
// beyond the near plane.
fn raised(clip: vec4f, view: u32, pixels: f32) -> f32 {
    // Of a pixel, at distance 1 in a perspective.
    let side = 2.0 * abs(frame.views[view].view_from_ndc.y) / frame.size.y;
    let reach = 0.5 * (pixels + 1.0) * side;
    let perspective = clip.z / max(1.0 - reach, 0.5);
    let orthographic = clip.z + clip.w * reach / frame.depth_range;
    let z = select(perspective, orthographic, frame.orthographic != 0u);
    return max(clip.z, min(z, clip.w));
}

// Where a corner of a quad lies in clip space. `here`: the point or the corner's end of the line;
// `there`: the other end; `corner`: as in the vertex.
//
// An end behind the near plane moves to it, because a quad that reaches behind the eye would cross
// itself. Its attributes are still the end's own. A line that is seen end-on is drawn as a point.
fn stroke_corner(here: vec4f, there: vec4f, corner: vec4f, view: u32) -> vec4f {
    let this_end = mix(here, there, cut_at_near(here, there));
    let other_end = mix(there, here, cut_at_near(there, here));
    let along = (other_end.xy / max(other_end.w, 1e-9) - this_end.xy / max(this_end.w, 1e-9)) * frame.size;
    let squared = dot(along, along);
    let end_on = vec2f(select(1.0, -1.0, abs(corner.w) > 1.5), 0.0);
    let unit = select(end_on, along * inverseSqrt(max(squared, 1e-12)), squared > 1e-12);
    let across = vec2f(-unit.y, unit.x) * sign(corner.w);
    // Square ends, which fill the gap between two lines that meet.
    let of_line = (across - unit) * frame.line_width;
    let of_point = corner.xy * frame.point_size;
    let is_point = corner.w == 0.0;
    let end = select(this_end, here, is_point);
    let moved = select(of_line, of_point, is_point) / frame.size;
    let z = raised(end, view, select(frame.line_width, frame.point_size, is_point));
    return vec4f(end.xy + moved * end.w, z, end.w);
}
