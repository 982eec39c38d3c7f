// SPDX-License-Identifier: GPL-3.0-or-later
// WebGL 2 programs.

const tableWidth = 2048;  // texels a line of textures that hold one number a footprint

const shaderSources = {
  /// Footprints, coloured through a table; some of them lit, the others then faint.
  footprints: [`
    layout(location = 0) in vec3 place;
    layout(location = 1) in uint footprint;
    uniform mat4 view;
    uniform highp sampler2D levels, colours;
    uniform highp usampler2D marks;
    uniform bool someLit;
    uniform vec3 litColour, faintColour;
    flat out vec3 colour;
    void main() {
      gl_Position = view * vec4(place, 1.0);
      ivec2 texel = ivec2(footprint % ${tableWidth}u, footprint / ${tableWidth}u);
      float level = texelFetch(levels, texel, 0).r;
      colour = texelFetch(colours, ivec2(clamp(level * 256.0, 0.0, 255.0), 0), 0).rgb;
      if (someLit) colour = texelFetch(marks, texel, 0).r > 0u ? litColour : mix(colour, faintColour, 0.45);
    }`, `
    flat in vec3 colour;
    out vec4 result;
    void main() { result = vec4(colour, 1.0); }`],
  /// The number of the footprint at a pixel, plus one.
  numbers: [`
    layout(location = 0) in vec3 place;
    layout(location = 1) in uint footprint;
    uniform mat4 view;
    flat out uint number;
    void main() {
      gl_Position = view * vec4(place, 1.0);
      number = footprint + 1u;
    }`, `
    flat in uint number;
    out vec4 result;
    void main() {
      result = vec4(number & 255u, number >> 8 & 255u, number >> 16 & 255u, number >> 24) / 255.0;
    }`],
  /// Facets and lines of one colour; facets lit from above, a little.
  plain: [`
    layout(location = 0) in vec3 place;
    uniform mat4 view;
    out vec3 where;
    void main() {
      gl_Position = view * vec4(place, 1.0);
      where = place;
    }`, `
    in vec3 where;
    uniform vec4 colour;
    uniform float shading;
    out vec4 result;
    void main() {
      float light = 1.0;
      if (shading > 0.0) {
        vec3 normal = cross(dFdx(where), dFdy(where));
        normal /= max(length(normal), 1e-30);
        light = 1.0 - shading + shading * abs(dot(normal, normalize(vec3(0.35, 0.25, 0.9))));
      }
      result = vec4(colour.rgb * light, colour.a);
    }`],
};

function makeProgram(gl, [vertex, fragment]) {
  const program = gl.createProgram();
  for (const [type, text] of [[gl.VERTEX_SHADER, vertex], [gl.FRAGMENT_SHADER, fragment]]) {
    const shader = gl.createShader(type);
    gl.shaderSource(shader, "#version 300 es\nprecision highp float;\nprecision highp int;\n" + text);
    gl.compileShader(shader);
    gl.attachShader(program, shader);
    if (!gl.getShaderParameter(shader, gl.COMPILE_STATUS)) throw new Error(gl.getShaderInfoLog(shader));
  }
  gl.linkProgram(program);
  if (!gl.getProgramParameter(program, gl.LINK_STATUS)) throw new Error(gl.getProgramInfoLog(program));
  const at = {};
  for (let k = 0; k < gl.getProgramParameter(program, gl.ACTIVE_UNIFORMS); ++k) {
    const { name } = gl.getActiveUniform(program, k);
    at[name] = gl.getUniformLocation(program, name);
  }
  return { program, at };
}
