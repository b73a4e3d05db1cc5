fn f(x: f32) -> f32 {
    return unpack2x16float(0x40003c00u).y + x;
}
