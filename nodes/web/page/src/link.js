// A link that opens the look, for others.

import { fragment } from "./address.js";
import { fault, note } from "./notes.js";

/** Copies a link to the look. */
export async function copyLink(look) {
  const link = new URL(fragment(look), location.href).href;
  // What a page from a folder is called is known to this computer alone.
  const isOwn = location.protocol === "file:";
  const warning = isOwn
    ? " It names a file on this computer, so that others cannot open it: send them the preset instead (Save preset), or put the page on a web server."
    : "";
  try {
    await navigator.clipboard.writeText(link);
    note(`The link is copied. It holds the look and no picture.${warning}`, { key: "link-copied", seconds: isOwn ? undefined : 4 });
  } catch {
    fault(`The browser does not let the page copy. Copy the address of this page instead: it holds the look, too.${warning}`, { key: "link-copied" });
  }
}
