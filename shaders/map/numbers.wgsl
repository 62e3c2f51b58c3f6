// What a filter is told besides the lookup: `numbers` of src/technique/map/filter/mod.rs.

@group(0) @binding(5) var<storage, read> numbers: array<vec4f>;
