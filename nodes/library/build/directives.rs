//! Directives of shaders: lines that begin with `#` and stand for text.

/// Formats of results, as storage textures name them.
const FORMATS: [&str; 3] = ["r32float", "rg32float", "rgba32float"];

/// Line of a shader that stands for text.
#[derive(Debug, PartialEq)]
pub enum Directive<'t> {
    /// `#import folder/name`: the text of the file `folder/name.wgsl`.
    Import(&'t str),
    /// `#insert folder/name`: statements of a function that several kernels have, in the place of the line.
    Insert(&'t str),
    /// `#params`: the variable `params`, the uniform block of the type `Params`.
    Params,
    /// `#input name, name`: textures that are read.
    Inputs(Vec<&'t str>),
    /// `#output name format`: a texture that is written, and the format of its exact results.
    Output(&'t str, &'t str),
}

impl<'t> Directive<'t> {
    /// The directive on this line, if there is one.
    ///
    /// # Errors
    /// Its form, where the line has another.
    pub fn read(line: &'t str) -> Result<Option<Self>, String> {
        let Some(text) = line.strip_prefix('#') else { return Ok(None) };
        let inputs =
            text.strip_prefix("input ").map(|names| names.split(',').map(str::trim).collect::<Vec<_>>());
        if let Some(names) = inputs.filter(|names| names.iter().all(|name| is_name(name))) {
            return Ok(Some(Self::Inputs(names)));
        }
        let words: Vec<&str> = text.split_whitespace().collect();
        let form = match words[..] {
            ["import", name] if name.contains('/') => return Ok(Some(Self::Import(name))),
            ["insert", name] if name.contains('/') => return Ok(Some(Self::Insert(name))),
            ["params"] => return Ok(Some(Self::Params)),
            ["output", name, format] if is_name(name) && FORMATS.contains(&format) => {
                return Ok(Some(Self::Output(name, format)));
            }
            ["import", ..] => "#import folder/name".to_owned(),
            ["insert", ..] => "#insert folder/name".to_owned(),
            ["params", ..] => "#params".to_owned(),
            ["input", ..] => "#input name, name, ...".to_owned(),
            ["output", ..] => format!("#output name format, with a format of {}", FORMATS.join(", ")),
            _ => return Err(format!("`{line}` is none of #import, #insert, #params, #input, #output")),
        };
        Err(format!("`{line}` is not of the form {form}"))
    }
}

/// True for what can be the name of a variable.
fn is_name(word: &str) -> bool {
    word.starts_with(|c: char| c.is_ascii_alphabetic())
        && word.chars().all(|c| c.is_ascii_alphanumeric() || c == '_')
}

/// The declaration of a variable at a binding.
fn bound(number: u32, variable: &str) -> String {
    format!("@group(0) @binding({number}) {variable};\n")
}

/// Bindings of a kernel as its directives declare them, in the order of their numbers: the uniform block is 1, and textures
/// count from 2.
#[derive(Default)]
pub struct Bindings {
    has_params: bool,
    inputs: u32,
    outputs: u32,
}

impl Bindings {
    /// The declarations that a directive stands for; other text declares nothing.
    ///
    /// # Errors
    /// Text that it should stand before.
    pub fn declare(&mut self, directive: Directive<'_>) -> Result<String, String> {
        let next = 2 + self.inputs + self.outputs;
        match directive {
            Directive::Import(_) | Directive::Insert(_) => Ok(String::new()),
            Directive::Params if self.has_params => Err("#params stands in a shader once".into()),
            Directive::Params if next > 2 => Err("#params stands before #input and #output".into()),
            Directive::Params => {
                self.has_params = true;
                Ok(bound(1, "var<uniform> params: Params"))
            }
            Directive::Inputs(_) if self.outputs > 0 => Err("#input stands before #output".into()),
            Directive::Inputs(names) => {
                self.inputs += names.len() as u32;
                let textures = (next..).zip(names);
                Ok(textures
                    .map(|(number, name)| bound(number, &format!("var {name}: texture_2d<f32>")))
                    .collect())
            }
            Directive::Output(name, format) => {
                self.outputs += 1;
                Ok(bound(next, &format!("var {name}: texture_storage_2d<{format}, write>")))
            }
        }
    }
}
