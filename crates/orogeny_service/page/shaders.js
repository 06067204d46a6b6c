// GLSL of the 3D view.

/** Heights come from a texture, one texel a sample; the patch is 64 × 64 quads with a skirt that hides cracks. */
export const GROUND_VERTEX = `#version 300 es
precision highp float;
precision highp int;
precision highp sampler2D;
in vec3 corner;            // quads from the north-west; z is 1 for the lower rim of the skirt
uniform sampler2D heights; // metres
uniform ivec2 first;       // sample of the patch's corner
uniform ivec2 last;        // the last sample that is known, from the patch on
uniform int stride;        // samples a quad
uniform float step_m;
uniform vec2 origin_m;     // place of sample (0, 0), relative to the camera's target
uniform float base_m;      // height that is drawn at 0
uniform float exaggeration;
uniform float skirt_m;
uniform mat4 view_projection;
out vec2 v_place_m;
out float v_height_m;
out vec2 v_at; // samples

float height_at(ivec2 at) { return texelFetch(heights, clamp(at, ivec2(0), last), 0).r; }

void main() {
  ivec2 at = min(first + ivec2(corner.xy) * stride, last);
  float height_m = height_at(at);
  v_place_m = origin_m + vec2(at) * step_m;
  v_height_m = height_m;
  v_at = vec2(at);
  float y = (height_m - base_m) * exaggeration - corner.z * skirt_m;
  gl_Position = view_projection * vec4(v_place_m.x, y, v_place_m.y, 1.0);
}`;

export const GROUND_FRAGMENT = `#version 300 es
precision highp float;
precision highp int;
precision highp sampler2D;
in vec2 v_place_m;
in float v_height_m;
in vec2 v_at;
uniform sampler2D heights;
uniform ivec2 last;
uniform float step_m;
uniform sampler2D palette;
uniform vec2 range_m;      // lowest, highest
uniform float exaggeration;
uniform sampler2D cover;    // for each page of a finer ground whether it is there
uniform ivec2 cover_pages;  // how many; none: there is no finer ground
uniform vec2 cover_origin_m;
uniform float cover_page_m;
uniform float cover_margin_m; // so far this ground reaches under the finer one, that no gap is seen
uniform vec4 terrain_m;    // x0, z0, x1, z1
uniform vec3 sun;
uniform vec2 rock_slope;
uniform vec3 sky;
uniform float far_m;
out vec4 colour;

bool is_covered(vec2 place_m) {
  vec2 inside_m = clamp(place_m, terrain_m.xy, terrain_m.zw);
  ivec2 page = ivec2(floor((inside_m - cover_origin_m) / cover_page_m));
  return all(greaterThanEqual(page, ivec2(0))) && all(lessThan(page, cover_pages)) && texelFetch(cover, page, 0).r > 0.5;
}

float height_at(ivec2 at) { return texelFetch(heights, clamp(at, ivec2(0), last), 0).r; }

/** Rise over run about a sample. */
vec2 slope_at(ivec2 at) {
  ivec2 low = max(at - 1, ivec2(0));
  ivec2 high = min(at + 1, last);
  vec2 rise = vec2(height_at(ivec2(high.x, at.y)) - height_at(ivec2(low.x, at.y)), height_at(ivec2(at.x, high.y)) - height_at(ivec2(at.x, low.y)));
  return rise / (vec2(max(high - low, ivec2(1))) * step_m);
}

/** Of every sample, however few of them are corners of triangles. */
vec2 slope_between() {
  ivec2 at = ivec2(floor(v_at));
  vec2 part = v_at - vec2(at);
  vec2 north = mix(slope_at(at), slope_at(at + ivec2(1, 0)), part.x);
  vec2 south = mix(slope_at(at + ivec2(0, 1)), slope_at(at + ivec2(1, 1)), part.x);
  return mix(north, south, part.y);
}

void main() {
  vec2 aside_m = vec2(cover_margin_m, -cover_margin_m);
  if (is_covered(v_place_m + aside_m.xx) && is_covered(v_place_m + aside_m.xy) && is_covered(v_place_m + aside_m.yx) && is_covered(v_place_m + aside_m.yy)) discard;
  float share = clamp((v_height_m - range_m.x) / max(range_m.y - range_m.x, 1e-6), 0.0, 1.0);
  vec3 ground = texture(palette, vec2(share * 255.0 / 256.0 + 0.5 / 256.0, 0.5)).rgb;
  vec2 slope = slope_between();
  float rock = smoothstep(rock_slope.x, rock_slope.y, length(slope)) * 0.75;
  ground = mix(ground, vec3(0.478, 0.439, 0.408), rock);
  // Somewhat steeper than it is, as on the map: else the finer forms are lost.
  vec2 steeper = slope * max(exaggeration, 1.4);
  steeper /= 1.0 + 0.25 * length(steeper);
  vec3 normal = normalize(vec3(-steeper.x, 1.0, -steeper.y));
  float lit = max(dot(normal, sun), 0.0);
  vec3 light = vec3(0.38, 0.42, 0.47) * (0.75 + 0.25 * normal.y) + vec3(0.98, 0.92, 0.83) * lit;
  float haze = smoothstep(0.35, 1.6, length(v_place_m) / far_m) * 0.75;
  colour = vec4(mix(ground * light, sky, haze), 1.0);
}`;

/** Rings on the ground: where pointers are. */
export const RING_VERTEX = `#version 300 es
precision highp float;
in vec3 place;
uniform mat4 view_projection;
void main() { gl_Position = view_projection * vec4(place, 1.0); }`;

export const RING_FRAGMENT = `#version 300 es
precision highp float;
uniform vec4 tint;
out vec4 colour;
void main() { colour = tint; }`;
