//! Scripts without their comments. The comments hold the types of the modules, for the compiler that
//! checks them, and are a third of what a browser would load.

/// A script with an empty line in place of each line that is a comment, and of the lines of each comment
/// that begins at the start of a line. So the numbers of lines stay. A comment behind code stays, too.
pub fn uncommented(script: &str) -> String {
    let mut out = String::with_capacity(script.len());
    let mut is_in_comment = false;
    for line in script.lines() {
        let mut rest = line;
        loop {
            let begins = rest.trim_start();
            if is_in_comment || begins.starts_with("/*") {
                let behind = rest.split_once("*/").map(|(_, behind)| behind);
                is_in_comment = behind.is_none();
                rest = behind.unwrap_or_default();
                if is_in_comment || rest.is_empty() {
                    break;
                }
            } else {
                rest = if begins.starts_with("//") { "" } else { rest };
                break;
            }
        }
        out.push_str(rest);
        out.push('\n');
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn comments_go_and_lines_and_code_stay() {
        let script = "// Head.\n\n/** @typedef {X} Y\n * more */\nlet a = 1; // why\n  /** @type {B} */ (b).c();\n\
                      /* one */ /* two */ d();\nconst url = \"https://x/*\";\n   /** long\n   end */ e();\n";
        let bare = "\n\n\n\nlet a = 1; // why\n (b).c();\n d();\nconst url = \"https://x/*\";\n\n e();\n";
        assert_eq!(uncommented(script), bare);
    }
}
