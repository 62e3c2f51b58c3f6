// Cells of one face that a caster may cover: twin of `Rectangle` in src/technique/irregular/grids.rs.

struct Rectangle {
    triangle: u32,
    face: u32,
    // x + y * 65536 of the first and the last cell.
    first: u32,
    last: u32,
}
