// What the G-buffer's identity holds besides the instance's number + 1 (0 = nothing): motion in pixels
// since the frame before, as two halves, whose lowest bit says whether the surface has moved in the
// world. Other light falls on it then. Zero where nothing asks for motion (`shared/vertex.wgsl`).

const HAS_MOVED: u32 = 1u;
