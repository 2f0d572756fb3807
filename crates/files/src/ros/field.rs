//! Fields of ROS 2 messages: what each of them holds, and how many of it.

/// A type built into ROS 2.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Primitive {
    /// One octet, 0 or 1.
    Bool,
    /// Signed integer of 1, 2, 4 or 8 bytes.
    Int(u8),
    /// Unsigned integer of 1, 2, 4 or 8 bytes; `byte` and `char` are those of 1 byte.
    Uint(u8),
    /// Number of 4 or 8 bytes.
    Float(u8),
    /// UTF-8 text.
    Text,
    /// Text of wide characters.
    WideText,
}

impl Primitive {
    pub(crate) fn is_number(self) -> bool {
        !matches!(self, Self::Text | Self::WideText)
    }
}

/// What one element of a field is.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Element {
    /// A built-in type.
    Primitive(Primitive),
    /// Another message: its place in `Definition::messages`.
    Message(usize),
}

/// How many elements a field has.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Arity {
    /// One.
    One,
    /// `[N]`: always N, without a count in front.
    Exactly(usize),
    /// `[]` or `[<=N]`: any number, with a count in front.
    Many,
}

/// A field of a message.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct Field {
    /// Its name.
    pub name: String,
    /// What it holds.
    pub element: Element,
    /// How many of these.
    pub arity: Arity,
}
