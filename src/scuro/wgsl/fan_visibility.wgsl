// How open a point is: the share of a fan's rays that nothing stops. Whoever includes this says where
// they go, by a function `fan_direction(fan: Fan, index: u32) -> vec3f`.

//#include "trace_fan.wgsl"

fn fan_quad(fan: Fan, first: u32) -> Quad {
    let a = fan_direction(fan, first);
    let b = fan_direction(fan, first + 1u);
    let c = fan_direction(fan, first + 2u);
    let d = fan_direction(fan, first + 3u);
    return Quad(vec4f(a.x, b.x, c.x, d.x), vec4f(a.y, b.y, c.y, d.y), vec4f(a.z, b.z, c.z, d.z));
}

fn fan_visibility(fan: Fan, samples: u32, t_max: f32) -> f32 {
    var open = 0.0;
    for (var first = 0u; first < samples; first += ROUND) {
        // the rays of this round that are still to be traced, a bit each
        var left = (1u << min(ROUND, samples - first)) - 1u;
        if (FIRST_CELL_AT_ONCE) {
            left &= fan_open(
                fan, t_max, fan_quad(fan, first), fan_quad(fan, first + 4u),
                fan_quad(fan, first + 8u), fan_quad(fan, first + 12u),
            );
        }
        var query: Pending;
        query.ended = true;
        query.found = true;
        loop {
            if (query.ended) {
                open += select(1.0, 0.0, query.found);
                if (left == 0u) {
                    break;
                }
                let direction = fan_direction(fan, first + firstTrailingBit(left));
                left &= left - 1u;
                query = any_begin(fan, direction, t_max);
            }
            any_go_on(&query);
        }
    }
    return open / f32(samples);
}
