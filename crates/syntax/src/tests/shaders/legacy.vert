// The style of OpenGL 2: no version line.
attribute vec3 tangent;
uniform float time;
varying vec3 normal;
varying vec2 uv;

void main()
{
    vec4 moved = gl_Vertex;
    moved.y += 0.25 * sin(time + moved.x * 3.0);
    normal = gl_NormalMatrix * gl_Normal + 0.01 * tangent;
    uv = (gl_TextureMatrix[0] * gl_MultiTexCoord0).st;
    gl_FrontColor = gl_Color * gl_LightSource[0].diffuse;
    gl_Position = gl_ModelViewProjectionMatrix * moved;
}
