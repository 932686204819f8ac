// The page: what is open, the look, and what ties them together.

import { Address, chosen, read, title } from "./address.js";
import { Browser } from "./browser.js";
import { busy } from "./busy.js";
import { byId } from "./dom.js";
import { openEngine, sentence } from "./engine.js";
import { listen, sort } from "./files.js";
import { keys, tabs } from "./keys.js";
import { copyLink } from "./link.js";
import { description, fromFile, isSame, titleOf } from "./look.js";
import { readModel } from "./gltf.js";
import { Model } from "./model.js";
import { Navigation } from "./navigation.js";
import { drop, fault, note, say } from "./notes.js";
import { Panel } from "./panel.js";
import { Picture, readPicture } from "./picture.js";
import { Playback } from "./playback.js";
import { menu, samples } from "./samples.js";
import { savePicture, savePreset } from "./saving.js";
import { Session } from "./session.js";
import { stillLife } from "./still-life.js";
import { Stage } from "./stage.js";
import { Thumbnails } from "./thumbnails.js";
import { Wipe } from "./wipe.js";

/** Times that a device may be lost before the processor takes over. */
const LOSSES = 3;

/** The look that a page without a link begins with. */
const FIRST = "saturday_comic";

class Page {
  session = new Session();
  stage = new Stage(byId("canvas"), (error) => this.failed(error));
  thumbnails = new Thumbnails(this.stage);
  /** How to open again what is open: after the device was lost. */
  #again = null;
  #opening = 0;
  #isSaving = false;
  #losses = 0;

  async start() {
    await this.#connect();
    const { catalogue } = this.isophote;
    this.browser = new Browser(catalogue, this.thumbnails, (entry) => this.session.choose(entry.look));
    this.panel = new Panel(catalogue, this.session);
    this.playback = new Playback();
    this.wipe = new Wipe(this.stage);
    this.navigation = new Navigation(this.stage, byId("canvas"));
    this.address = new Address((hash) => this.#follow(hash));
    this.session.addEventListener("look", ({ detail }) => this.#changed(detail));
    this.#tools();
    this.stage.addEventListener("busy", () => busy("computing", true));
    this.stage.addEventListener("rest", () => busy("computing", false));
    this.stage.addEventListener("shown", () => {
      busy("computing", false);
      drop("computing");
    });
    listen((entries) => this.open(entries), (error) => this.failed(error));
    this.#begin();
    busy("start", false);
  }

  /** Opens what computes, and tells when that is the processor. */
  async #connect() {
    const { isophote, why } = await openEngine((message) => this.#lost(message), this.#losses < LOSSES);
    this.isophote = isophote;
    this.stage.connect(isophote);
    const isSlow = isophote.backend === "cpu";
    byId("backend").hidden = !isSlow;
    if (isSlow) {
      byId("backend").title = why;
      note(`Computed on the processor: slower. ${why}`, { key: "backend" });
    }
  }

  #begin() {
    const first = this.browser.entry(FIRST).look;
    let look = null;
    try {
      look = this.#checked(read(location.hash));
    } catch (error) {
      fault(error.message, { key: "link" });
    }
    const own = look === null ? { chosen: first } : { chosen: chosen(), title: title() };
    this.session.choose(look ?? first, { why: "address", ...own });
    const [sample] = samples();
    this.#openPicture(sample.blob(), sample.name);
  }

  /** The look, if the library takes it. */
  #checked(look) {
    if (look !== null) {
      try {
        this.isophote.graph(look);
      } catch (error) {
        throw new Error(`The link's look cannot be shown: ${sentence(error)}`);
      }
    }
    return look;
  }

  #follow(hash) {
    try {
      const look = this.#checked(read(hash));
      if (look !== null) {
        drop("link");
        this.session.choose(look, { why: "address", chosen: chosen(), title: title() });
      }
    } catch (error) {
      fault(error.message, { key: "link" });
    }
  }

  #changed(why) {
    const { look, chosen: before, title: own } = this.session;
    const known = this.browser.find(before) ?? description(this.isophote.catalogue, look);
    const [name, about] = [own?.name || known.name, own?.about || known.about];
    this.lookName = name;
    byId("look-name").textContent = name;
    byId("look-about").textContent = about;
    byId("reset").disabled = isSame(look, before);
    byId("undo").disabled = !this.session.canUndo;
    byId("redo").disabled = !this.session.canRedo;
    if (why !== "edit") {
      this.panel.force();
      say(`Look: ${this.lookName}`);
    }
    this.#showPanel();
    this.browser.mark(look);
    this.stage.setLook(look);
    if (why !== "address") {
      this.address.show(look, { chosen: before, title: own }, why === "choose");
    }
    document.title = `${this.lookName} – Isophote`;
  }

  #showPanel() {
    this.panel.show(this.session.look, (this.stage.subject?.guides.length ?? 0) > 0);
  }

  /** Opens what was dropped, chosen or pasted. */
  async open(entries) {
    const { kind, main } = sort(entries);
    byId("hint").hidden = true;
    if (kind === "preset") {
      await this.#openPreset(main.file);
    } else if (kind === "model") {
      await this.#openModel(entries, main);
    } else if (kind === "picture") {
      await this.#openPicture(main.file, main.file.name);
    }
  }

  async #openPreset(file) {
    try {
      const json = JSON.parse(await file.text());
      const look = fromFile(json);
      this.isophote.graph(look);
      this.session.choose(look, { title: titleOf(json, file.name) });
      drop("file");
    } catch (error) {
      const why = error instanceof SyntaxError ? "it is no JSON" : error.message;
      fault(`${file.name} is no preset of Isophote: ${why.replace(/\.$/, "")}. Presets are saved by this page and by the other programs.`, { key: "file" });
    }
  }

  #openPicture(blob, name) {
    return this.#show(async () => {
      const bitmap = await readPicture(blob, name);
      return () => Picture.open(this.isophote, bitmap, name, this.stage);
    });
  }

  #openModel(entries, main) {
    return this.#show(async () => {
      // It is read anew for another device: what three.js has uploaded belongs to the old one.
      return async () => {
        const content = await readModel(entries, main);
        content.warnings.forEach((text) => note(text, { key: "textures" }));
        return Model.open(this.isophote, content, this.stage);
      };
    });
  }

  #openStillLife() {
    return this.#show(async () => () => Model.open(this.isophote, stillLife(), this.stage));
  }

  /**
   * Shows a subject. Of several that are opened, the last counts.
   * @param read resolves to what makes the subject, and makes it again
   */
  async #show(read) {
    this.#opening += 1;
    const opening = this.#opening;
    busy("opening", true);
    try {
      const make = await read();
      const subject = await make();
      if (opening !== this.#opening) {
        subject.close();
        return;
      }
      this.#again = make;
      drop("file");
      this.stage.show(subject);
      this.playback.show(subject);
      byId("info").textContent = subject.info;
      this.#showPanel();
      say(`${subject.info} is open`);
      this.thumbnails.setSource(this.isophote, await subject.thumbnail());
      this.browser.renew();
    } catch (error) {
      if (opening === this.#opening) {
        fault(sentence(error), { key: "file" });
      }
    } finally {
      if (opening === this.#opening) {
        busy("opening", false);
      }
    }
  }

  #tools() {
    const { session } = this;
    byId("undo").addEventListener("click", () => session.undo());
    byId("redo").addEventListener("click", () => session.redo());
    byId("reset").addEventListener("click", () => this.reset());
    byId("link").addEventListener("click", () => {
      this.address.flush();
      copyLink(session.look);
    });
    byId("preset").addEventListener("click", () => savePreset(session.look, this.lookName));
    byId("save").addEventListener("click", () => this.save());
    byId("hint-close").addEventListener("click", () => { byId("hint").hidden = true; });
    const pictures = samples().map(({ name, blob }) => ({ name, open: () => this.#openPicture(blob(), name) }));
    menu([...pictures, { name: "A still life, in 3D", open: () => this.#openStillLife() }]);
    keys(this);
    tabs();
  }

  /** Back to the look as it was chosen. */
  reset() {
    this.panel.force();
    this.session.edit(this.session.chosen, null);
  }

  /** Saves the picture, one at a time. */
  async save() {
    const { subject } = this.stage;
    if (subject === null || this.#isSaving) {
      return;
    }
    this.#isSaving = true;
    byId("save").disabled = true;
    busy("saving", true);
    try {
      await savePicture(this.isophote, this.session.look, subject, this.lookName);
    } catch (error) {
      fault(`The picture was not saved. ${sentence(error)}`, { key: "saved" });
    } finally {
      this.#isSaving = false;
      byId("save").disabled = false;
      busy("saving", false);
    }
  }

  /** Tells what failed while something was computed. */
  failed(error) {
    if (!this.isLost) {
      fault(sentence(error), { key: "computing" });
    }
  }

  #lost(message) {
    this.isLost = true;
    this.#losses += 1;
    const why = message ? ` (${message})` : "";
    fault(`The graphics device was lost${why}. Often it was busy for too long, or its driver was renewed.`, {
      key: "lost",
      action: { label: "Go on", run: () => this.#goOn() },
    });
  }

  async #goOn() {
    try {
      await this.#connect();
      this.isLost = false;
      await this.#show(async () => this.#again);
    } catch (error) {
      fault(`${sentence(error)} Load the page again; the look stays in its address.`, { key: "lost" });
    }
  }
}

// Nothing fails unseen.
addEventListener("unhandledrejection", (event) => {
  event.preventDefault();
  fault(sentence(event.reason), { key: "fault" });
});
addEventListener("error", (event) => fault(sentence(event.error ?? event.message), { key: "fault" }));

new Page().start().catch((error) => {
  document.body.classList.add("dead");
  busy("start", false);
  fault(sentence(error), { key: "start" });
});
