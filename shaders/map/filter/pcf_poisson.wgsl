// Twin of src/technique/map/filter/pcf_poisson.rs.

// In 1024ths of the radius.
const PATTERN = array<vec2i, 64>(
    vec2i(0, 0), vec2i(-286, -983), vec2i(973, -319), vec2i(632, 805), vec2i(-545, 865), vec2i(-992, -244),
    vec2i(466, -885), vec2i(-597, 244), vec2i(590, 187), vec2i(42, 641), vec2i(-442, -421), vec2i(431, -340),
    vec2i(29, -618), vec2i(1014, 108), vec2i(-787, -645), vec2i(-1003, 161), vec2i(-136, 1012), vec2i(270, 967),
    vec2i(-834, 592), vec2i(887, 486), vec2i(-217, 334), vec2i(777, -639), vec2i(100, -987), vec2i(384, 502),
    vec2i(-382, -63), vec2i(686, -128), vec2i(-126, -311), vec2i(-708, -75), vec2i(-298, 651), vec2i(328, -20),
    vec2i(115, 317), vec2i(-484, -741), vec2i(331, -626), vec2i(-730, -368), vec2i(-552, 527), vec2i(152, -349),
    vec2i(-247, -626), vec2i(697, -389), vec2i(633, 555), vec2i(353, 255), vec2i(-93, -834), vec2i(-836, 342),
    vec2i(362, 743), vec2i(810, 272), vec2i(45, 868), vec2i(-368, 164), vec2i(541, -550), vec2i(-318, 879),
    vec2i(901, -91), vec2i(-788, 130), vec2i(217, -807), vec2i(-547, -215), vec2i(-162, 129), vec2i(-910, -467),
    vec2i(175, 118), vec2i(765, 65), vec2i(-920, -35), vec2i(-427, 363), vec2i(-136, 525), vec2i(-178, -100),
    vec2i(-592, -557), vec2i(166, -138), vec2i(-323, -252), vec2i(-140, 787),
);

fn filter_visibility(position_in_texels: vec2f, reference: f32) -> f32 {
    var pattern = PATTERN;
    var lit = 0u;
    for (var i = 0u; i < lookup.kernel; i++) {
        let offset = turned(vec2f(pattern[i]) * (pattern_radius_texels() / 1024.0));
        lit += u32(is_lit(reference, vec2i(floor(position_in_texels + offset))));
    }
    return f32(lit) / f32(lookup.kernel);
}
