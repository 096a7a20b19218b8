// An integer hash (Wang 2007): the same numbers on every device.

fn hash(value: u32) -> u32 {
    var h = (value ^ 61u) ^ (value >> 16u);
    h *= 9u;
    h ^= h >> 4u;
    h *= 0x27d4eb2du;
    return h ^ (h >> 15u);
}
