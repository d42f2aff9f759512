//! Blocks of code of a page in Markdown, with the comments for the test directly above them. docs/writing.md
//! lists both.

/// What a comment above a block says.
#[derive(Debug, Clone, PartialEq)]
pub(super) enum Note {
    /// The block is a fragment of this scenario.
    Base(String),
    /// Name of a file; its content, if the comment contains it.
    File(String, Option<String>),
    /// Command that is run before the block.
    Setup(String),
    /// Text that is replaced by another.
    Replace(String, String),
    /// Command whose output the block is.
    Output(String),
    /// Exit code of the commands.
    Exit(i32),
    /// File that contains the lines of the block.
    From(String),
    /// The block takes more than a second.
    Long,
    /// Why the block is not tested.
    Skip(String),
}

impl Note {
    pub(super) fn base(&self) -> Option<&str> {
        if let Self::Base(file) = self { Some(file) } else { None }
    }

    /// Name of the file whose content is the block.
    pub(super) fn shown_file(&self) -> Option<&str> {
        if let Self::File(name, None) = self { Some(name) } else { None }
    }

    pub(super) fn output(&self) -> Option<&str> {
        if let Self::Output(command) = self { Some(command) } else { None }
    }

    pub(super) fn exit(&self) -> Option<i32> {
        if let Self::Exit(code) = self { Some(*code) } else { None }
    }

    pub(super) fn from(&self) -> Option<&str> {
        if let Self::From(file) = self { Some(file) } else { None }
    }
}

/// A fenced block of code.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Block {
    /// Number of the line of the fence, from 1.
    pub(super) line: usize,
    pub(super) language: String,
    pub(super) text: String,
    pub(super) notes: Vec<Note>,
}

impl Block {
    /// What the first of its comments says that `of` reads.
    pub(super) fn find<'a, T>(&'a self, of: impl Fn(&'a Note) -> Option<T>) -> Option<T> {
        self.notes.iter().find_map(of)
    }

    /// The text after the replacements for the test.
    pub(super) fn replaced(&self) -> Result<String, String> {
        self.notes.iter().try_fold(self.text.clone(), |text, note| match note {
            Note::Replace(old, new) if text.contains(old) => Ok(text.replace(old, new)),
            Note::Replace(old, _) => {
                Err(format!("the block does not contain `{old}`, which is to be replaced"))
            }
            _ => Ok(text),
        })
    }
}

/// Returns the blocks of a page, in order.
pub(super) fn blocks(page: &str) -> Result<Vec<Block>, String> {
    let mut lines = page.lines().enumerate().map(|(index, line)| (index + 1, line));
    let (mut found, mut notes): (Vec<Block>, Vec<Note>) = (Vec::new(), Vec::new());
    while let Some((number, line)) = lines.next() {
        let at = |error: String| format!("line {number}: {error}");
        let indent = line.len() - line.trim_start().len();
        if let Some(comment) = line.trim_start().strip_prefix("<!--") {
            let comment =
                whole_comment(comment, &mut lines).ok_or_else(|| at("the comment has no end".to_owned()))?;
            notes.extend(note(&comment).map_err(at)?);
        } else if let Some(language) = line.trim_start().strip_prefix("```") {
            let mut text = String::new();
            loop {
                let (_, line) = lines.next().ok_or_else(|| at("the block has no end".to_owned()))?;
                if line.trim() == "```" {
                    break;
                }
                let shown = line.get(indent..).filter(|_| line[..indent].trim().is_empty());
                text += shown.unwrap_or(line.trim_start());
                text.push('\n');
            }
            let notes = std::mem::take(&mut notes);
            found.push(Block { line: number, language: language.trim().to_owned(), text, notes });
        } else if !line.trim().is_empty() && !notes.is_empty() {
            return Err(at(format!("{notes:?} does not stand directly above a block")));
        }
    }
    Ok(found)
}

/// Returns the text of a comment that may go on in the following lines; `None` if it has no end.
fn whole_comment<'a>(first: &str, lines: &mut impl Iterator<Item = (usize, &'a str)>) -> Option<String> {
    let mut text = first.to_owned();
    while !text.contains("-->") {
        text.push('\n');
        text += lines.next()?.1;
    }
    Some(text.split_once("-->")?.0.to_owned())
}

/// Returns what a comment says to the test; `None` if it says nothing to it.
fn note(comment: &str) -> Result<Option<Note>, String> {
    let (first, rest) = comment.split_once('\n').map_or((comment, None), |(first, rest)| (first, Some(rest)));
    let (name, value) = first.split_once(':').unwrap_or((first, ""));
    let value = value.trim().to_owned();
    let note = match (name.trim(), rest) {
        ("long", None) if value.is_empty() => return Ok(Some(Note::Long)),
        ("file", rest) => Note::File(value.clone(), rest.map(str::to_owned)),
        ("base", None) => Note::Base(value.clone()),
        ("setup", None) => Note::Setup(value.clone()),
        ("output", None) => Note::Output(value.clone()),
        ("from", None) => Note::From(value.clone()),
        ("exit", None) => Note::Exit(value.parse().map_err(|_| format!("`{value}` is no exit code"))?),
        ("skip", rest) => Note::Skip(format!("{value} {}", rest.unwrap_or_default()).trim().to_owned()),
        ("replace", None) => {
            let (old, new) = value.split_once(" -> ").ok_or("expected `replace: OLD -> NEW`")?;
            Note::Replace(old.to_owned(), new.to_owned())
        }
        _ => return Ok(None),
    };
    let is_empty = value.is_empty() && note == Note::Skip(String::new());
    if is_empty || (value.is_empty() && !matches!(note, Note::Skip(_))) {
        return Err(format!("`{}:` is empty", name.trim()));
    }
    Ok(Some(note))
}

#[test]
fn blocks_of_a_page_have_their_language_and_comments() {
    let page = "# A\n\n<!-- keys: a -->\n<!-- end -->\n\n<!-- base: a.toml -->\n<!-- replace: 10 -> 2 -->\n\n```toml\na = 10\n```\n\
                - b\n\n  ```sh\n  ls\n    x\n  ```\n<!-- file: s.csv\n1,2\n-->\n<!-- long -->\n```python\n```\n";
    let found = blocks(page).unwrap();
    let languages: Vec<&str> = found.iter().map(|block| &*block.language).collect();
    assert_eq!(languages, ["toml", "sh", "python"]);
    assert_eq!(found[0].replaced().unwrap(), "a = 2\n");
    assert_eq!((found[0].line, &*found[1].text), (9, "ls\n  x\n"));
    assert_eq!(found[2].notes, [Note::File("s.csv".to_owned(), Some("1,2\n".to_owned())), Note::Long]);
}

#[test]
fn wrong_comments_are_reported() {
    for (page, says) in [
        ("<!-- base: a.toml -->\ntext\n```toml\n```\n", "does not stand directly above a block"),
        ("<!-- skip: -->\n```sh\n```\n", "`skip:` is empty"),
        ("<!-- exit: two -->\n", "no exit code"),
        ("<!-- replace: a -->\n", "OLD -> NEW"),
        ("```sh\nls\n", "line 1: the block has no end"),
    ] {
        let error = blocks(page).unwrap_err();
        assert!(error.contains(says), "{page}: {error}");
    }
    let block = &blocks("<!-- replace: a -> b -->\n```sh\nls\n```\n").unwrap()[0];
    assert!(block.replaced().unwrap_err().contains("does not contain `a`"));
}
