fn f() -> vec4<i32> {
    return select(vec4<i32>(vec3<i32>(1, 1, 1), 1), vec4<i32>(1, 1, 1, 1), vec4<bool>(true, true, true, true));
}
