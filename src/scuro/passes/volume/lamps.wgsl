// The scene's lights, as every pass over volumes binds them.

//#include "lights.wgsl"

@group(2) @binding(2) var<uniform> lights: Lights;
