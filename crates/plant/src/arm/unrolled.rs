//! Loops over axes that are written out, so that what one turn gives the next stays in registers: the
//! compiler keeps a loop as long as these, and its arrays in memory.

/// `unrolled!(for i in a..b { .. })` and `unrolled!(for i in (a..b).rev() { .. })` do what the loops
/// without the macro do, up to seven axes.
macro_rules! unrolled {
    (for $i:ident in $from:tt..$to:tt $body:block) => {
        unrolled!(@ $i $from $to $body 0 1 2 3 4 5 6)
    };
    (for $i:ident in ($from:tt..$to:tt).rev() $body:block) => {
        unrolled!(@ $i $from $to $body 6 5 4 3 2 1 0)
    };
    (@ $i:ident $from:tt $to:tt $body:block $($k:literal)*) => {$(
        if ($from..$to).contains(&$k) {
            let $i: usize = $k;
            $body
        }
    )*};
}

pub(crate) use unrolled;
