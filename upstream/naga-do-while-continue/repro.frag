#version 450
layout(location = 0) in vec4 p;
layout(location = 0) out vec4 color;
void main() {
    int rounds = 0;
    do {
        rounds++;
        if (rounds > 1) continue;
    } while (rounds < 2);
    color = vec4(float(rounds));
}
