#version 300 es
// Colour of a value, with isolines; `shade` in maps.js has the same formulas for the canvas.
precision highp float;
in float v;
uniform sampler2D colours;  // 256 × 1
uniform vec2 range;         // values of the first and the last colour
uniform vec2 ends;          // smallest and largest value of the legend; colours do not change beyond
uniform vec2 bounds;        // values outside mark a gap
uniform float yields;       // values from here on mark a yielding support
uniform float every;        // distance of isolines in the unit of the value
uniform float dot;          // device pixels per CSS pixel
uniform float size;         // height of the picture [device pixels]
out vec4 colour;

void main() {
  vec2 at = vec2(gl_FragCoord.x, size - gl_FragCoord.y);
  float g = length(vec2(dFdx(v), dFdy(v)));
  if (v <= bounds.x || v >= bounds.y) {
    bool hatch = mod(at.x + at.y, 9.0 * dot) < dot;
    colour = vec4(vec3(hatch ? 0.80 : 0.97), 1.0);
    return;
  }
  int index = int(clamp((clamp(v, ends.x, ends.y) - range.x) / (range.y - range.x), 0.0, 1.0) * 255.999);
  vec3 c = texelFetch(colours, ivec2(index, 0), 0).rgb;
  if (every > 0.0 && g > 0.0) {
    float apart = every / g / dot;                       // distance of isolines [CSS pixels]
    float near = abs(v / every - round(v / every)) * apart;
    // Isolines fade where they would merge, and where the field is flat.
    float line = round(v / every) * every;
    bool within = line > ends.x && line < ends.y;
    float fade = within ? smoothstep(3.0, 9.0, apart) * (1.0 - smoothstep(400.0, 1200.0, apart)) : 0.0;
    c *= 1.0 - 0.45 * fade * (1.0 - smoothstep(0.3, 1.1, near));
  }
  if (v >= yields && mod(at.x - at.y, 7.0 * dot) < dot) c = mix(c, vec3(1.0), 0.5);
  colour = vec4(c, 1.0);
}
