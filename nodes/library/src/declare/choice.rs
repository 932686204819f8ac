//! Choices: enums whose options are declared once, each with its id, its label and its document; and enums
//! that shaders know by numbers.

use crate::declare::value::Choice;

/// An enum that shaders know by numbers.
pub trait Numbered: Copy + 'static {
    /// All of them.
    const ALL: &'static [Self];

    /// Number of each in shaders.
    fn number(self) -> u32;

    /// The one that shaders know by this number, which a uniform block of this library holds.
    ///
    /// # Panics
    /// For a number that stands for none.
    fn of(number: u32) -> Self {
        let found = Self::ALL.iter().find(|option| option.number() == number);
        *found.unwrap_or_else(|| panic!("{number} is none of {}", std::any::type_name::<Self>()))
    }
}

/// An enum that a parameter offers as a choice, in the order of [`Numbered::ALL`].
pub trait Selectable: Numbered {
    /// Label of each, in the same order.
    const OPTIONS: &'static [Choice];
}

/// An option, usually a default, among the options of its enum.
#[derive(Clone, Copy, Debug)]
pub struct Selection {
    /// Which of them.
    pub index: usize,
    /// All of them.
    pub options: &'static [Choice],
}

/// Declares an enum that a parameter offers as a choice. An option is its document, its name and, in
/// parentheses, its id and its label. The order is that of panels. An enum that shaders know by a number
/// states the number of each option:
///
/// ```ignore
/// choice! {
///     /// Spatial weight of the neighbours.
///     pub enum Window {
///         /// 1 within the radius.
///         Box = 0 ("box", "Box"),
///         /// A Gaussian that is cut at the radius.
///         Gaussian = 1 ("gaussian", "Gaussian"),
///     }
/// }
/// ```
macro_rules! choice {
    (
        $(#[$meta:meta])*
        $vis:vis enum $name:ident {
            $($(#[doc = $doc:literal])+ $option:ident $(= $number:literal)? ($id:literal, $label:literal),)+
        }
    ) => {
        $(#[$meta])*
        #[derive(Clone, Copy, Debug, PartialEq, Eq)]
        $vis enum $name {
            $($(#[doc = $doc])+ $option $(= $number)?,)+
        }

        impl $crate::declare::choice::Numbered for $name {
            const ALL: &'static [Self] = &[$(Self::$option,)+];

            fn number(self) -> u32 {
                self as u32
            }
        }

        impl $crate::declare::choice::Selectable for $name {
            const OPTIONS: &'static [$crate::declare::value::Choice] = &[$(
                $crate::declare::value::Choice { id: $id, label: $label, doc: concat!($($doc,)+).trim_ascii() },
            )+];
        }

        impl $name {
            /// This option among all.
            $vis const fn selected(self) -> $crate::declare::choice::Selection {
                use $crate::declare::choice::{Numbered, Selectable};
                let mut index = 0;
                while Self::ALL[index] as u32 != self as u32 {
                    index += 1;
                }
                $crate::declare::choice::Selection { index, options: Self::OPTIONS }
            }
        }
    };
}
pub(crate) use choice;

/// Declares an enum that shaders know by numbers and that no parameter offers.
macro_rules! numbered {
    ($(#[$meta:meta])* $vis:vis enum $name:ident { $($(#[$doc:meta])+ $option:ident = $number:literal,)+ }) => {
        $(#[$meta])*
        #[derive(Clone, Copy, Debug, PartialEq, Eq)]
        $vis enum $name {
            $($(#[$doc])+ $option = $number,)+
        }

        impl $crate::declare::choice::Numbered for $name {
            const ALL: &'static [Self] = &[$(Self::$option,)+];

            fn number(self) -> u32 {
                self as u32
            }
        }
    };
}
pub(crate) use numbered;

#[cfg(test)]
mod tests {
    use super::*;

    choice! {
        /// Ways to smooth.
        enum Smoothing {
            /// A mean over
            /// a square.
            Box = 3 ("box", "Box filter"),
            /// A Gaussian.
            Gaussian = 1 ("gaussian", "Gaussian"),
        }
    }

    #[test]
    fn options_keep_the_order_of_the_declaration_whatever_their_numbers() {
        assert_eq!(Smoothing::ALL, [Smoothing::Box, Smoothing::Gaussian]);
        assert_eq!(Smoothing::Gaussian as u32, 1);
        assert_eq!([Smoothing::Box, Smoothing::Gaussian].map(|s| s.selected().index), [0, 1]);
        let options = Smoothing::Box.selected().options;
        assert_eq!(options.iter().map(|o| o.id).collect::<Vec<_>>(), ["box", "gaussian"]);
        assert_eq!((options[0].label, options[0].doc), ("Box filter", "A mean over a square."));
    }

    #[test]
    #[should_panic(expected = "2 is none of")]
    fn numbers_name_their_options_and_nothing_else() {
        assert_eq!([3, 1].map(Smoothing::of), [Smoothing::Box, Smoothing::Gaussian]);
        Smoothing::of(2);
    }
}
