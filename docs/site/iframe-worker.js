// The search of the site runs in a worker, which browsers refuse to pages opened as files. There, this stands in for
// it: the worker's script runs in a hidden frame of the page.
if (location.protocol === "file:") {
  window.IFrameWorker = class extends EventTarget {
    constructor(url) {
      super();
      const frame = document.createElement("iframe");
      frame.hidden = true;
      frame.srcdoc = `<script>
        self.IFrameWorker = parent.IFrameWorker;
        self.postMessage = data => frameElement.answer(data);
        self.importScripts = (...urls) => urls.reduce((done, url) => done.then(() => new Promise((loaded, failed) => {
          const script = document.createElement("script");
          Object.assign(script, {src: url, onload: loaded, onerror: failed});
          document.head.append(script);
        })), Promise.resolve());
      <\/script><script src="${new URL(url, document.baseURI)}"><\/script>`;
      frame.answer = data => this.dispatchEvent(new MessageEvent("message", {data}));
      this.ready = new Promise(ready => frame.addEventListener("load", () => ready(frame.contentWindow), {once: true}));
      document.body.append(frame);
    }

    postMessage(data) {
      this.ready.then(target => target.dispatchEvent(new target.MessageEvent("message", {data})));
    }
  };
  window.Worker = window.IFrameWorker;
}
