#version 300 es
// Orthographic projection of a node of the plate at (x, y) with the deflection w, positive down.
in float placeX;
in float placeY;
in float deflection;
in float value;
uniform mat3 turn;      // rows: right, up, away from the eye
uniform vec2 scale;     // clip units per unit of length
uniform vec2 middle;    // projected point in the middle of the picture
uniform float times;    // exaggeration of the deflection
uniform float deep;     // depth units per unit of length
out float v;

void main() {
  vec3 seen = vec3(placeX, placeY, -times * deflection) * turn;
  gl_Position = vec4((seen.xy - middle) * scale, clamp(deep * seen.z, -1.0, 1.0), 1.0);
  v = value;
}
