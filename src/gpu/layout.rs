//! For tests: where the fields of a Rust struct lie, and those of its WGSL twin.

use super::shader::{Wgsl, concatenated};

/// Names and byte offsets of a struct's fields in order, and its size in bytes.
#[derive(Debug, PartialEq, Eq)]
pub(crate) struct Layout {
    pub(crate) fields: Vec<(String, usize)>,
    pub(crate) bytes: usize,
}

/// The layout of the struct that some WGSL files, together, declare under this name.
pub(crate) fn wgsl_layout(files: &[Wgsl], name: &str) -> Layout {
    let module = naga::front::wgsl::parse_str(&concatenated(files)).unwrap();
    let (_, found) = module.types.iter().find(|(_, found)| found.name.as_deref() == Some(name)).unwrap();
    let naga::TypeInner::Struct { members, span } = &found.inner else { panic!("{name} is no struct") };
    let field = |member: &naga::StructMember| (member.name.clone().unwrap(), member.offset as usize);
    Layout { fields: members.iter().map(field).collect(), bytes: *span as usize }
}

/// The layout of a Rust struct, all of whose fields must be named, in order.
macro_rules! rust_layout {
    ($name:ident { $($field:ident),* $(,)? }) => {{
        let _names_all = |value: $name| { let $name { $($field: _),* } = value; };
        $crate::gpu::layout::Layout {
            fields: vec![$((stringify!($field).to_owned(), std::mem::offset_of!($name, $field))),*],
            bytes: size_of::<$name>(),
        }
    }};
}
pub(crate) use rust_layout;

#[cfg(test)]
mod tests {
    use super::*;

    const TEXT: Wgsl = Wgsl {
        path: "test",
        text: "struct Pair { first: u32, second: vec2f, } @group(0) @binding(0) var<storage> pairs: array<Pair>;",
    };

    #[repr(C)]
    struct Pair {
        first: u32,
        _gap: u32,
        second: [f32; 2],
    }

    #[test]
    fn alignment_shuffling_and_renaming_are_seen() {
        let of_wgsl = wgsl_layout(&[TEXT], "Pair");
        assert_eq!(of_wgsl, Layout { fields: vec![("first".into(), 0), ("second".into(), 8)], bytes: 16 });
        let with_gap = rust_layout!(Pair { first, _gap, second });
        assert_eq!((with_gap.fields.last(), with_gap.bytes), (of_wgsl.fields.last(), of_wgsl.bytes));
        assert_ne!(with_gap, of_wgsl, "an unnamed gap is a difference");

        #[repr(C)]
        struct Shuffled {
            second: [f32; 2],
            first: u32,
            padding: u32,
        }
        assert_ne!(rust_layout!(Shuffled { second, first, padding }), of_wgsl);
    }
}
