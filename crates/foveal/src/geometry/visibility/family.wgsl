// What one dispatch evaluates. Rust: `scene/families.rs`.

struct Family {
    // Workgroups of 64 pixels, as an indirect dispatch wants them.
    groups_x: u32,
    groups_y: u32,
    groups_z: u32,
    count: u32,
    // Where in `pixels` its pixels begin.
    first: u32,
    // Its bins.
    begin: u32,
    end: u32,
    reserved: u32,
}
