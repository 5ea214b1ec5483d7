/*! This file contains three.js. SPDX-License-Identifier: MIT
The MIT License

Copyright © 2010-2026 three.js authors

Permission is hereby granted, free of charge, to any person obtaining a copy
of this software and associated documentation files (the "Software"), to deal
in the Software without restriction, including without limitation the rights
to use, copy, modify, merge, publish, distribute, sublicense, and/or sell
copies of the Software, and to permit persons to whom the Software is
furnished to do so, subject to the following conditions:

The above copyright notice and this permission notice shall be included in
all copies or substantial portions of the Software.

THE SOFTWARE IS PROVIDED "AS IS", WITHOUT WARRANTY OF ANY KIND, EXPRESS OR
IMPLIED, INCLUDING BUT NOT LIMITED TO THE WARRANTIES OF MERCHANTABILITY,
FITNESS FOR A PARTICULAR PURPOSE AND NONINFRINGEMENT. IN NO EVENT SHALL THE
AUTHORS OR COPYRIGHT HOLDERS BE LIABLE FOR ANY CLAIM, DAMAGES OR OTHER
LIABILITY, WHETHER IN AN ACTION OF CONTRACT, TORT OR OTHERWISE, ARISING FROM,
OUT OF OR IN CONNECTION WITH THE SOFTWARE OR THE USE OR OTHER DEALINGS IN
THE SOFTWARE.
*//**
 * @license
 * Copyright 2010-2026 Three.js Authors
 * SPDX-License-Identifier: MIT
 */const qt="srgb",Ls="srgb-linear",Ds="linear",tt="srgb";const ca="300 es";function bl(s){for(let e=s.length-1;e>=0;--e)if(s[e]>=65535)return!0;return!1}function Ns(s){return document.createElementNS("http://www.w3.org/1999/xhtml",s)}function El(){const s=Ns("canvas");return s.style.display="block",s}const ha={};function da(...s){const e="THREE."+s.shift();console.log(e,...s)}function Ro(s){const e=s[0];if(typeof e=="string"&&e.startsWith("TSL:")){const t=s[1];t&&t.isStackTrace?s[0]+=" "+t.getLocation():s[1]='Stack trace not available. Enable "THREE.Node.captureStackTrace" to capture stack traces.'}return s}function Le(...s){s=Ro(s);const e="THREE."+s.shift();{const t=s[0];t&&t.isStackTrace?console.warn(t.getError(e)):console.warn(e,...s)}}function Je(...s){s=Ro(s);const e="THREE."+s.shift();{const t=s[0];t&&t.isStackTrace?console.error(t.getError(e)):console.error(e,...s)}}function Ts(...s){const e=s.join(" ");e in ha||(ha[e]=!0,Le(...s))}function Tl(s,e,t){return new Promise(function(n,i){function r(){switch(s.clientWaitSync(e,s.SYNC_FLUSH_COMMANDS_BIT,0)){case s.WAIT_FAILED:i();break;case s.TIMEOUT_EXPIRED:setTimeout(r,t);break;default:n()}}setTimeout(r,t)})}const Al={0:0,2:6,4:4,3:5,1:1,6:2,7:7,5:3};class Jn{addEventListener(e,t){this._listeners===void 0&&(this._listeners={});const n=this._listeners;n[e]===void 0&&(n[e]=[]),n[e].indexOf(t)===-1&&n[e].push(t)}hasEventListener(e,t){const n=this._listeners;return n===void 0?!1:n[e]!==void 0&&n[e].indexOf(t)!==-1}removeEventListener(e,t){const n=this._listeners;if(n===void 0)return;const i=n[e];if(i!==void 0){const r=i.indexOf(t);r!==-1&&i.splice(r,1)}}dispatchEvent(e){const t=this._listeners;if(t===void 0)return;const n=t[e.type];if(n!==void 0){e.target=this;const i=n.slice(0);for(let r=0,a=i.length;r<a;r++)i[r].call(this,e);e.target=null}}}const Pt=["00","01","02","03","04","05","06","07","08","09","0a","0b","0c","0d","0e","0f","10","11","12","13","14","15","16","17","18","19","1a","1b","1c","1d","1e","1f","20","21","22","23","24","25","26","27","28","29","2a","2b","2c","2d","2e","2f","30","31","32","33","34","35","36","37","38","39","3a","3b","3c","3d","3e","3f","40","41","42","43","44","45","46","47","48","49","4a","4b","4c","4d","4e","4f","50","51","52","53","54","55","56","57","58","59","5a","5b","5c","5d","5e","5f","60","61","62","63","64","65","66","67","68","69","6a","6b","6c","6d","6e","6f","70","71","72","73","74","75","76","77","78","79","7a","7b","7c","7d","7e","7f","80","81","82","83","84","85","86","87","88","89","8a","8b","8c","8d","8e","8f","90","91","92","93","94","95","96","97","98","99","9a","9b","9c","9d","9e","9f","a0","a1","a2","a3","a4","a5","a6","a7","a8","a9","aa","ab","ac","ad","ae","af","b0","b1","b2","b3","b4","b5","b6","b7","b8","b9","ba","bb","bc","bd","be","bf","c0","c1","c2","c3","c4","c5","c6","c7","c8","c9","ca","cb","cc","cd","ce","cf","d0","d1","d2","d3","d4","d5","d6","d7","d8","d9","da","db","dc","dd","de","df","e0","e1","e2","e3","e4","e5","e6","e7","e8","e9","ea","eb","ec","ed","ee","ef","f0","f1","f2","f3","f4","f5","f6","f7","f8","f9","fa","fb","fc","fd","fe","ff"],Qs=Math.PI/180,Pr=180/Math.PI;function zi(){const s=Math.random()*4294967295|0,e=Math.random()*4294967295|0,t=Math.random()*4294967295|0,n=Math.random()*4294967295|0;return(Pt[s&255]+Pt[s>>8&255]+Pt[s>>16&255]+Pt[s>>24&255]+"-"+Pt[e&255]+Pt[e>>8&255]+"-"+Pt[e>>16&15|64]+Pt[e>>24&255]+"-"+Pt[t&63|128]+Pt[t>>8&255]+"-"+Pt[t>>16&255]+Pt[t>>24&255]+Pt[n&255]+Pt[n>>8&255]+Pt[n>>16&255]+Pt[n>>24&255]).toLowerCase()}function ze(s,e,t){return Math.max(e,Math.min(t,s))}function Rl(s,e){return(s%e+e)%e}function js(s,e,t){return(1-t)*s+t*e}function Cl(s){return Math.pow(2,Math.floor(Math.log(s)/Math.LN2))}function Gr(s){switch(s.constructor){case Uint32Array:return 4294967295;case Uint16Array:return 65535;case Uint8Array:case Uint8ClampedArray:return 255;case Int32Array:return 2147483647;case Int16Array:return 32767;case Int8Array:return 127;default:return}}function Pl(s,e){if(e.constructor===Float32Array)return s;const t=Gr(e);if(t===void 0)throw new Error("THREE.MathUtils: Invalid component type.");return Math.max(s/t,-1)}function Ll(s,e){if(e.constructor===Float32Array)return s;const t=Gr(e);if(t===void 0)throw new Error("THREE.MathUtils: Invalid component type.");return Math.round(s*t)}class Ye{static{this.prototype.isVector2=!0}constructor(e=0,t=0){this.x=e,this.y=t}get width(){return this.x}set width(e){this.x=e}get height(){return this.y}set height(e){this.y=e}set(e,t){return this.x=e,this.y=t,this}setScalar(e){return this.x=e,this.y=e,this}setX(e){return this.x=e,this}setY(e){return this.y=e,this}setComponent(e,t){switch(e){case 0:this.x=t;break;case 1:this.y=t;break;default:throw new Error("THREE.Vector2: index is out of range: "+e)}return this}getComponent(e){switch(e){case 0:return this.x;case 1:return this.y;default:throw new Error("THREE.Vector2: index is out of range: "+e)}}clone(){return new this.constructor(this.x,this.y)}copy(e){return this.x=e.x,this.y=e.y,this}add(e){return this.x+=e.x,this.y+=e.y,this}addScalar(e){return this.x+=e,this.y+=e,this}addVectors(e,t){return this.x=e.x+t.x,this.y=e.y+t.y,this}addScaledVector(e,t){return this.x+=e.x*t,this.y+=e.y*t,this}sub(e){return this.x-=e.x,this.y-=e.y,this}subScalar(e){return this.x-=e,this.y-=e,this}subVectors(e,t){return this.x=e.x-t.x,this.y=e.y-t.y,this}multiply(e){return this.x*=e.x,this.y*=e.y,this}multiplyScalar(e){return this.x*=e,this.y*=e,this}divide(e){return this.x/=e.x,this.y/=e.y,this}divideScalar(e){return this.multiplyScalar(1/e)}applyMatrix3(e){const t=this.x,n=this.y,i=e.elements;return this.x=i[0]*t+i[3]*n+i[6],this.y=i[1]*t+i[4]*n+i[7],this}min(e){return this.x=Math.min(this.x,e.x),this.y=Math.min(this.y,e.y),this}max(e){return this.x=Math.max(this.x,e.x),this.y=Math.max(this.y,e.y),this}clamp(e,t){return this.x=ze(this.x,e.x,t.x),this.y=ze(this.y,e.y,t.y),this}clampScalar(e,t){return this.x=ze(this.x,e,t),this.y=ze(this.y,e,t),this}clampLength(e,t){const n=this.length();return this.divideScalar(n||1).multiplyScalar(ze(n,e,t))}floor(){return this.x=Math.floor(this.x),this.y=Math.floor(this.y),this}ceil(){return this.x=Math.ceil(this.x),this.y=Math.ceil(this.y),this}round(){return this.x=Math.round(this.x),this.y=Math.round(this.y),this}roundToZero(){return this.x=Math.trunc(this.x),this.y=Math.trunc(this.y),this}negate(){return this.x=-this.x,this.y=-this.y,this}dot(e){return this.x*e.x+this.y*e.y}cross(e){return this.x*e.y-this.y*e.x}lengthSq(){return this.x*this.x+this.y*this.y}length(){return Math.sqrt(this.x*this.x+this.y*this.y)}manhattanLength(){return Math.abs(this.x)+Math.abs(this.y)}normalize(){return this.divideScalar(this.length()||1)}angle(){return Math.atan2(-this.y,-this.x)+Math.PI}angleTo(e){const t=Math.sqrt(this.lengthSq()*e.lengthSq());if(t===0)return Math.PI/2;const n=this.dot(e)/t;return Math.acos(ze(n,-1,1))}distanceTo(e){return Math.sqrt(this.distanceToSquared(e))}distanceToSquared(e){const t=this.x-e.x,n=this.y-e.y;return t*t+n*n}manhattanDistanceTo(e){return Math.abs(this.x-e.x)+Math.abs(this.y-e.y)}setLength(e){return this.normalize().multiplyScalar(e)}lerp(e,t){return this.x+=(e.x-this.x)*t,this.y+=(e.y-this.y)*t,this}lerpVectors(e,t,n){return this.x=e.x+(t.x-e.x)*n,this.y=e.y+(t.y-e.y)*n,this}equals(e){return e.x===this.x&&e.y===this.y}fromArray(e,t=0){return this.x=e[t],this.y=e[t+1],this}toArray(e=[],t=0){return e[t]=this.x,e[t+1]=this.y,e}fromBufferAttribute(e,t){return this.x=e.getX(t),this.y=e.getY(t),this}rotateAround(e,t){const n=Math.cos(t),i=Math.sin(t),r=this.x-e.x,a=this.y-e.y;return this.x=r*n-a*i+e.x,this.y=r*i+a*n+e.y,this}random(){return this.x=Math.random(),this.y=Math.random(),this}*[Symbol.iterator](){yield this.x,yield this.y}}class Un{constructor(e=0,t=0,n=0,i=1){this.isQuaternion=!0,this._x=e,this._y=t,this._z=n,this._w=i}static slerpFlat(e,t,n,i,r,a,o){let l=n[i+0],c=n[i+1],h=n[i+2],u=n[i+3],d=r[a+0],f=r[a+1],g=r[a+2],S=r[a+3];if(u!==S||l!==d||c!==f||h!==g){let m=l*d+c*f+h*g+u*S;m<0&&(d=-d,f=-f,g=-g,S=-S,m=-m);let p=1-o;if(m<.9995){const M=Math.acos(m),A=Math.sin(M);p=Math.sin(p*M)/A,o=Math.sin(o*M)/A,l=l*p+d*o,c=c*p+f*o,h=h*p+g*o,u=u*p+S*o}else{l=l*p+d*o,c=c*p+f*o,h=h*p+g*o,u=u*p+S*o;const M=1/Math.sqrt(l*l+c*c+h*h+u*u);l*=M,c*=M,h*=M,u*=M}}e[t]=l,e[t+1]=c,e[t+2]=h,e[t+3]=u}static multiplyQuaternionsFlat(e,t,n,i,r,a){const o=n[i],l=n[i+1],c=n[i+2],h=n[i+3],u=r[a],d=r[a+1],f=r[a+2],g=r[a+3];return e[t]=o*g+h*u+l*f-c*d,e[t+1]=l*g+h*d+c*u-o*f,e[t+2]=c*g+h*f+o*d-l*u,e[t+3]=h*g-o*u-l*d-c*f,e}get x(){return this._x}set x(e){this._x=e,this._onChangeCallback()}get y(){return this._y}set y(e){this._y=e,this._onChangeCallback()}get z(){return this._z}set z(e){this._z=e,this._onChangeCallback()}get w(){return this._w}set w(e){this._w=e,this._onChangeCallback()}set(e,t,n,i){return this._x=e,this._y=t,this._z=n,this._w=i,this._onChangeCallback(),this}clone(){return new this.constructor(this._x,this._y,this._z,this._w)}copy(e){return this._x=e.x,this._y=e.y,this._z=e.z,this._w=e.w,this._onChangeCallback(),this}setFromEuler(e,t=!0){const n=e._x,i=e._y,r=e._z,a=e._order,o=Math.cos,l=Math.sin,c=o(n/2),h=o(i/2),u=o(r/2),d=l(n/2),f=l(i/2),g=l(r/2);switch(a){case"XYZ":this._x=d*h*u+c*f*g,this._y=c*f*u-d*h*g,this._z=c*h*g+d*f*u,this._w=c*h*u-d*f*g;break;case"YXZ":this._x=d*h*u+c*f*g,this._y=c*f*u-d*h*g,this._z=c*h*g-d*f*u,this._w=c*h*u+d*f*g;break;case"ZXY":this._x=d*h*u-c*f*g,this._y=c*f*u+d*h*g,this._z=c*h*g+d*f*u,this._w=c*h*u-d*f*g;break;case"ZYX":this._x=d*h*u-c*f*g,this._y=c*f*u+d*h*g,this._z=c*h*g-d*f*u,this._w=c*h*u+d*f*g;break;case"YZX":this._x=d*h*u+c*f*g,this._y=c*f*u+d*h*g,this._z=c*h*g-d*f*u,this._w=c*h*u-d*f*g;break;case"XZY":this._x=d*h*u-c*f*g,this._y=c*f*u-d*h*g,this._z=c*h*g+d*f*u,this._w=c*h*u+d*f*g;break;default:Le("Quaternion: .setFromEuler() encountered an unknown order: "+a)}return t===!0&&this._onChangeCallback(),this}setFromAxisAngle(e,t){const n=t/2,i=Math.sin(n);return this._x=e.x*i,this._y=e.y*i,this._z=e.z*i,this._w=Math.cos(n),this._onChangeCallback(),this}setFromRotationMatrix(e){const t=e.elements,n=t[0],i=t[4],r=t[8],a=t[1],o=t[5],l=t[9],c=t[2],h=t[6],u=t[10],d=n+o+u;if(d>0){const f=.5/Math.sqrt(d+1);this._w=.25/f,this._x=(h-l)*f,this._y=(r-c)*f,this._z=(a-i)*f}else if(n>o&&n>u){const f=2*Math.sqrt(1+n-o-u);this._w=(h-l)/f,this._x=.25*f,this._y=(i+a)/f,this._z=(r+c)/f}else if(o>u){const f=2*Math.sqrt(1+o-n-u);this._w=(r-c)/f,this._x=(i+a)/f,this._y=.25*f,this._z=(l+h)/f}else{const f=2*Math.sqrt(1+u-n-o);this._w=(a-i)/f,this._x=(r+c)/f,this._y=(l+h)/f,this._z=.25*f}return this._onChangeCallback(),this}setFromUnitVectors(e,t){let n=e.dot(t)+1;return n<1e-8?(n=0,Math.abs(e.x)>Math.abs(e.z)?(this._x=-e.y,this._y=e.x,this._z=0,this._w=n):(this._x=0,this._y=-e.z,this._z=e.y,this._w=n)):(this._x=e.y*t.z-e.z*t.y,this._y=e.z*t.x-e.x*t.z,this._z=e.x*t.y-e.y*t.x,this._w=n),this.normalize()}angleTo(e){return 2*Math.acos(Math.abs(ze(this.dot(e),-1,1)))}rotateTowards(e,t){const n=this.angleTo(e);if(n===0)return this;const i=Math.min(1,t/n);return this.slerp(e,i),this}identity(){return this.set(0,0,0,1)}invert(){return this.conjugate()}conjugate(){return this._x*=-1,this._y*=-1,this._z*=-1,this._onChangeCallback(),this}dot(e){return this._x*e._x+this._y*e._y+this._z*e._z+this._w*e._w}lengthSq(){return this._x*this._x+this._y*this._y+this._z*this._z+this._w*this._w}length(){return Math.sqrt(this._x*this._x+this._y*this._y+this._z*this._z+this._w*this._w)}normalize(){let e=this.length();return e===0?(this._x=0,this._y=0,this._z=0,this._w=1):(e=1/e,this._x=this._x*e,this._y=this._y*e,this._z=this._z*e,this._w=this._w*e),this._onChangeCallback(),this}multiply(e){return this.multiplyQuaternions(this,e)}premultiply(e){return this.multiplyQuaternions(e,this)}multiplyQuaternions(e,t){const n=e._x,i=e._y,r=e._z,a=e._w,o=t._x,l=t._y,c=t._z,h=t._w;return this._x=n*h+a*o+i*c-r*l,this._y=i*h+a*l+r*o-n*c,this._z=r*h+a*c+n*l-i*o,this._w=a*h-n*o-i*l-r*c,this._onChangeCallback(),this}slerp(e,t){let n=e._x,i=e._y,r=e._z,a=e._w,o=this.dot(e);o<0&&(n=-n,i=-i,r=-r,a=-a,o=-o);let l=1-t;if(o<.9995){const c=Math.acos(o),h=Math.sin(c);l=Math.sin(l*c)/h,t=Math.sin(t*c)/h,this._x=this._x*l+n*t,this._y=this._y*l+i*t,this._z=this._z*l+r*t,this._w=this._w*l+a*t,this._onChangeCallback()}else this._x=this._x*l+n*t,this._y=this._y*l+i*t,this._z=this._z*l+r*t,this._w=this._w*l+a*t,this.normalize();return this}slerpQuaternions(e,t,n){return this.copy(e).slerp(t,n)}random(){const e=2*Math.PI*Math.random(),t=2*Math.PI*Math.random(),n=Math.random(),i=Math.sqrt(1-n),r=Math.sqrt(n);return this.set(i*Math.sin(e),i*Math.cos(e),r*Math.sin(t),r*Math.cos(t))}equals(e){return e._x===this._x&&e._y===this._y&&e._z===this._z&&e._w===this._w}fromArray(e,t=0){return this._x=e[t],this._y=e[t+1],this._z=e[t+2],this._w=e[t+3],this._onChangeCallback(),this}toArray(e=[],t=0){return e[t]=this._x,e[t+1]=this._y,e[t+2]=this._z,e[t+3]=this._w,e}fromBufferAttribute(e,t){return this._x=e.getX(t),this._y=e.getY(t),this._z=e.getZ(t),this._w=e.getW(t),this._onChangeCallback(),this}toJSON(){return this.toArray()}_onChange(e){return this._onChangeCallback=e,this}_onChangeCallback(){}*[Symbol.iterator](){yield this._x,yield this._y,yield this._z,yield this._w}}class D{static{this.prototype.isVector3=!0}constructor(e=0,t=0,n=0){this.x=e,this.y=t,this.z=n}set(e,t,n){return n===void 0&&(n=this.z),this.x=e,this.y=t,this.z=n,this}setScalar(e){return this.x=e,this.y=e,this.z=e,this}setX(e){return this.x=e,this}setY(e){return this.y=e,this}setZ(e){return this.z=e,this}setComponent(e,t){switch(e){case 0:this.x=t;break;case 1:this.y=t;break;case 2:this.z=t;break;default:throw new Error("THREE.Vector3: index is out of range: "+e)}return this}getComponent(e){switch(e){case 0:return this.x;case 1:return this.y;case 2:return this.z;default:throw new Error("THREE.Vector3: index is out of range: "+e)}}clone(){return new this.constructor(this.x,this.y,this.z)}copy(e){return this.x=e.x,this.y=e.y,this.z=e.z,this}add(e){return this.x+=e.x,this.y+=e.y,this.z+=e.z,this}addScalar(e){return this.x+=e,this.y+=e,this.z+=e,this}addVectors(e,t){return this.x=e.x+t.x,this.y=e.y+t.y,this.z=e.z+t.z,this}addScaledVector(e,t){return this.x+=e.x*t,this.y+=e.y*t,this.z+=e.z*t,this}sub(e){return this.x-=e.x,this.y-=e.y,this.z-=e.z,this}subScalar(e){return this.x-=e,this.y-=e,this.z-=e,this}subVectors(e,t){return this.x=e.x-t.x,this.y=e.y-t.y,this.z=e.z-t.z,this}multiply(e){return this.x*=e.x,this.y*=e.y,this.z*=e.z,this}multiplyScalar(e){return this.x*=e,this.y*=e,this.z*=e,this}multiplyVectors(e,t){return this.x=e.x*t.x,this.y=e.y*t.y,this.z=e.z*t.z,this}applyEuler(e){return this.applyQuaternion(ua.setFromEuler(e))}applyAxisAngle(e,t){return this.applyQuaternion(ua.setFromAxisAngle(e,t))}applyMatrix3(e){const t=this.x,n=this.y,i=this.z,r=e.elements;return this.x=r[0]*t+r[3]*n+r[6]*i,this.y=r[1]*t+r[4]*n+r[7]*i,this.z=r[2]*t+r[5]*n+r[8]*i,this}applyNormalMatrix(e){return this.applyMatrix3(e).normalize()}applyMatrix4(e){const t=this.x,n=this.y,i=this.z,r=e.elements,a=1/(r[3]*t+r[7]*n+r[11]*i+r[15]);return this.x=(r[0]*t+r[4]*n+r[8]*i+r[12])*a,this.y=(r[1]*t+r[5]*n+r[9]*i+r[13])*a,this.z=(r[2]*t+r[6]*n+r[10]*i+r[14])*a,this}applyQuaternion(e){const t=this.x,n=this.y,i=this.z,r=e.x,a=e.y,o=e.z,l=e.w,c=2*(a*i-o*n),h=2*(o*t-r*i),u=2*(r*n-a*t);return this.x=t+l*c+a*u-o*h,this.y=n+l*h+o*c-r*u,this.z=i+l*u+r*h-a*c,this}project(e){return this.applyMatrix4(e.matrixWorldInverse).applyMatrix4(e.projectionMatrix)}unproject(e){return this.applyMatrix4(e.projectionMatrixInverse).applyMatrix4(e.matrixWorld)}transformDirection(e){const t=this.x,n=this.y,i=this.z,r=e.elements;return this.x=r[0]*t+r[4]*n+r[8]*i,this.y=r[1]*t+r[5]*n+r[9]*i,this.z=r[2]*t+r[6]*n+r[10]*i,this.normalize()}divide(e){return this.x/=e.x,this.y/=e.y,this.z/=e.z,this}divideScalar(e){return this.multiplyScalar(1/e)}min(e){return this.x=Math.min(this.x,e.x),this.y=Math.min(this.y,e.y),this.z=Math.min(this.z,e.z),this}max(e){return this.x=Math.max(this.x,e.x),this.y=Math.max(this.y,e.y),this.z=Math.max(this.z,e.z),this}clamp(e,t){return this.x=ze(this.x,e.x,t.x),this.y=ze(this.y,e.y,t.y),this.z=ze(this.z,e.z,t.z),this}clampScalar(e,t){return this.x=ze(this.x,e,t),this.y=ze(this.y,e,t),this.z=ze(this.z,e,t),this}clampLength(e,t){const n=this.length();return this.divideScalar(n||1).multiplyScalar(ze(n,e,t))}floor(){return this.x=Math.floor(this.x),this.y=Math.floor(this.y),this.z=Math.floor(this.z),this}ceil(){return this.x=Math.ceil(this.x),this.y=Math.ceil(this.y),this.z=Math.ceil(this.z),this}round(){return this.x=Math.round(this.x),this.y=Math.round(this.y),this.z=Math.round(this.z),this}roundToZero(){return this.x=Math.trunc(this.x),this.y=Math.trunc(this.y),this.z=Math.trunc(this.z),this}negate(){return this.x=-this.x,this.y=-this.y,this.z=-this.z,this}dot(e){return this.x*e.x+this.y*e.y+this.z*e.z}lengthSq(){return this.x*this.x+this.y*this.y+this.z*this.z}length(){return Math.sqrt(this.x*this.x+this.y*this.y+this.z*this.z)}manhattanLength(){return Math.abs(this.x)+Math.abs(this.y)+Math.abs(this.z)}normalize(){return this.divideScalar(this.length()||1)}setLength(e){return this.normalize().multiplyScalar(e)}lerp(e,t){return this.x+=(e.x-this.x)*t,this.y+=(e.y-this.y)*t,this.z+=(e.z-this.z)*t,this}lerpVectors(e,t,n){return this.x=e.x+(t.x-e.x)*n,this.y=e.y+(t.y-e.y)*n,this.z=e.z+(t.z-e.z)*n,this}cross(e){return this.crossVectors(this,e)}crossVectors(e,t){const n=e.x,i=e.y,r=e.z,a=t.x,o=t.y,l=t.z;return this.x=i*l-r*o,this.y=r*a-n*l,this.z=n*o-i*a,this}projectOnVector(e){const t=e.lengthSq();if(t===0)return this.set(0,0,0);const n=e.dot(this)/t;return this.copy(e).multiplyScalar(n)}projectOnPlane(e){return er.copy(this).projectOnVector(e),this.sub(er)}reflect(e){return this.sub(er.copy(e).multiplyScalar(2*this.dot(e)))}angleTo(e){const t=Math.sqrt(this.lengthSq()*e.lengthSq());if(t===0)return Math.PI/2;const n=this.dot(e)/t;return Math.acos(ze(n,-1,1))}distanceTo(e){return Math.sqrt(this.distanceToSquared(e))}distanceToSquared(e){const t=this.x-e.x,n=this.y-e.y,i=this.z-e.z;return t*t+n*n+i*i}manhattanDistanceTo(e){return Math.abs(this.x-e.x)+Math.abs(this.y-e.y)+Math.abs(this.z-e.z)}setFromSpherical(e){return this.setFromSphericalCoords(e.radius,e.phi,e.theta)}setFromSphericalCoords(e,t,n){const i=Math.sin(t)*e;return this.x=i*Math.sin(n),this.y=Math.cos(t)*e,this.z=i*Math.cos(n),this}setFromCylindrical(e){return this.setFromCylindricalCoords(e.radius,e.theta,e.y)}setFromCylindricalCoords(e,t,n){return this.x=e*Math.sin(t),this.y=n,this.z=e*Math.cos(t),this}setFromMatrixPosition(e){const t=e.elements;return this.x=t[12],this.y=t[13],this.z=t[14],this}setFromMatrixScale(e){const t=this.setFromMatrixColumn(e,0).length(),n=this.setFromMatrixColumn(e,1).length(),i=this.setFromMatrixColumn(e,2).length();return this.x=t,this.y=n,this.z=i,this}setFromMatrixColumn(e,t){return this.fromArray(e.elements,t*4)}setFromMatrix3Column(e,t){return this.fromArray(e.elements,t*3)}setFromEuler(e){return this.x=e._x,this.y=e._y,this.z=e._z,this}setFromColor(e){return this.x=e.r,this.y=e.g,this.z=e.b,this}equals(e){return e.x===this.x&&e.y===this.y&&e.z===this.z}fromArray(e,t=0){return this.x=e[t],this.y=e[t+1],this.z=e[t+2],this}toArray(e=[],t=0){return e[t]=this.x,e[t+1]=this.y,e[t+2]=this.z,e}fromBufferAttribute(e,t){return this.x=e.getX(t),this.y=e.getY(t),this.z=e.getZ(t),this}random(){return this.x=Math.random(),this.y=Math.random(),this.z=Math.random(),this}randomDirection(){const e=Math.random()*Math.PI*2,t=Math.random()*2-1,n=Math.sqrt(1-t*t);return this.x=n*Math.cos(e),this.y=t,this.z=n*Math.sin(e),this}*[Symbol.iterator](){yield this.x,yield this.y,yield this.z}}const er=new D,ua=new Un;class Ue{static{this.prototype.isMatrix3=!0}constructor(e,t,n,i,r,a,o,l,c){this.elements=[1,0,0,0,1,0,0,0,1],e!==void 0&&this.set(e,t,n,i,r,a,o,l,c)}set(e,t,n,i,r,a,o,l,c){const h=this.elements;return h[0]=e,h[1]=i,h[2]=o,h[3]=t,h[4]=r,h[5]=l,h[6]=n,h[7]=a,h[8]=c,this}identity(){return this.set(1,0,0,0,1,0,0,0,1),this}copy(e){const t=this.elements,n=e.elements;return t[0]=n[0],t[1]=n[1],t[2]=n[2],t[3]=n[3],t[4]=n[4],t[5]=n[5],t[6]=n[6],t[7]=n[7],t[8]=n[8],this}extractBasis(e,t,n){return e.setFromMatrix3Column(this,0),t.setFromMatrix3Column(this,1),n.setFromMatrix3Column(this,2),this}setFromMatrix4(e){const t=e.elements;return this.set(t[0],t[4],t[8],t[1],t[5],t[9],t[2],t[6],t[10]),this}multiply(e){return this.multiplyMatrices(this,e)}premultiply(e){return this.multiplyMatrices(e,this)}multiplyMatrices(e,t){const n=e.elements,i=t.elements,r=this.elements,a=n[0],o=n[3],l=n[6],c=n[1],h=n[4],u=n[7],d=n[2],f=n[5],g=n[8],S=i[0],m=i[3],p=i[6],M=i[1],A=i[4],b=i[7],R=i[2],E=i[5],_=i[8];return r[0]=a*S+o*M+l*R,r[3]=a*m+o*A+l*E,r[6]=a*p+o*b+l*_,r[1]=c*S+h*M+u*R,r[4]=c*m+h*A+u*E,r[7]=c*p+h*b+u*_,r[2]=d*S+f*M+g*R,r[5]=d*m+f*A+g*E,r[8]=d*p+f*b+g*_,this}multiplyScalar(e){const t=this.elements;return t[0]*=e,t[3]*=e,t[6]*=e,t[1]*=e,t[4]*=e,t[7]*=e,t[2]*=e,t[5]*=e,t[8]*=e,this}determinant(){const e=this.elements,t=e[0],n=e[1],i=e[2],r=e[3],a=e[4],o=e[5],l=e[6],c=e[7],h=e[8];return t*a*h-t*o*c-n*r*h+n*o*l+i*r*c-i*a*l}invert(){const e=this.elements,t=e[0],n=e[1],i=e[2],r=e[3],a=e[4],o=e[5],l=e[6],c=e[7],h=e[8],u=h*a-o*c,d=o*l-h*r,f=c*r-a*l,g=t*u+n*d+i*f;if(g===0)return this.set(0,0,0,0,0,0,0,0,0);const S=1/g;return e[0]=u*S,e[1]=(i*c-h*n)*S,e[2]=(o*n-i*a)*S,e[3]=d*S,e[4]=(h*t-i*l)*S,e[5]=(i*r-o*t)*S,e[6]=f*S,e[7]=(n*l-c*t)*S,e[8]=(a*t-n*r)*S,this}transpose(){let e;const t=this.elements;return e=t[1],t[1]=t[3],t[3]=e,e=t[2],t[2]=t[6],t[6]=e,e=t[5],t[5]=t[7],t[7]=e,this}getNormalMatrix(e){return this.setFromMatrix4(e).invert().transpose()}transposeIntoArray(e){const t=this.elements;return e[0]=t[0],e[1]=t[3],e[2]=t[6],e[3]=t[1],e[4]=t[4],e[5]=t[7],e[6]=t[2],e[7]=t[5],e[8]=t[8],this}setUvTransform(e,t,n,i,r,a,o){const l=Math.cos(r),c=Math.sin(r);return this.set(n*l,n*c,-n*(l*a+c*o)+a+e,-i*c,i*l,-i*(-c*a+l*o)+o+t,0,0,1),this}scale(e,t){return Ts("Matrix3: .scale() is deprecated. Use .makeScale() instead."),this.premultiply(tr.makeScale(e,t)),this}rotate(e){return Ts("Matrix3: .rotate() is deprecated. Use .makeRotation() instead."),this.premultiply(tr.makeRotation(-e)),this}translate(e,t){return Ts("Matrix3: .translate() is deprecated. Use .makeTranslation() instead."),this.premultiply(tr.makeTranslation(e,t)),this}makeTranslation(e,t){return e.isVector2?this.set(1,0,e.x,0,1,e.y,0,0,1):this.set(1,0,e,0,1,t,0,0,1),this}makeRotation(e){const t=Math.cos(e),n=Math.sin(e);return this.set(t,-n,0,n,t,0,0,0,1),this}makeScale(e,t){return this.set(e,0,0,0,t,0,0,0,1),this}equals(e){const t=this.elements,n=e.elements;for(let i=0;i<9;i++)if(t[i]!==n[i])return!1;return!0}fromArray(e,t=0){for(let n=0;n<9;n++)this.elements[n]=e[n+t];return this}toArray(e=[],t=0){const n=this.elements;return e[t]=n[0],e[t+1]=n[1],e[t+2]=n[2],e[t+3]=n[3],e[t+4]=n[4],e[t+5]=n[5],e[t+6]=n[6],e[t+7]=n[7],e[t+8]=n[8],e}clone(){return new this.constructor().fromArray(this.elements)}}const tr=new Ue,fa=new Ue().set(.4123908,.3575843,.1804808,.212639,.7151687,.0721923,.0193308,.1191948,.9505322),pa=new Ue().set(3.2409699,-1.5373832,-.4986108,-.9692436,1.8759675,.0415551,.0556301,-.203977,1.0569715);function Dl(){const s={enabled:!0,workingColorSpace:Ls,spaces:{},convert:function(i,r,a){return this.enabled===!1||r===a||!r||!a||(this.spaces[r].transfer===tt&&(i.r=yn(i.r),i.g=yn(i.g),i.b=yn(i.b)),this.spaces[r].primaries!==this.spaces[a].primaries&&(i.applyMatrix3(this.spaces[r].toXYZ),i.applyMatrix3(this.spaces[a].fromXYZ)),this.spaces[a].transfer===tt&&(i.r=fi(i.r),i.g=fi(i.g),i.b=fi(i.b))),i},workingToColorSpace:function(i,r){return this.convert(i,this.workingColorSpace,r)},colorSpaceToWorking:function(i,r){return this.convert(i,r,this.workingColorSpace)},getPrimaries:function(i){return this.spaces[i].primaries},getTransfer:function(i){return i===""?Ds:this.spaces[i].transfer},getToneMappingMode:function(i){return this.spaces[i].outputColorSpaceConfig.toneMappingMode||"standard"},getLuminanceCoefficients:function(i,r=this.workingColorSpace){return i.fromArray(this.spaces[r].luminanceCoefficients)},define:function(i){Object.assign(this.spaces,i)},_getMatrix:function(i,r,a){return i.copy(this.spaces[a].fromXYZ).multiply(this.spaces[r].toXYZ)},_getDrawingBufferColorSpace:function(i){return this.spaces[i].outputColorSpaceConfig.drawingBufferColorSpace},_getUnpackColorSpace:function(i=this.workingColorSpace){return this.spaces[i].workingColorSpaceConfig.unpackColorSpace}},e=[.64,.33,.3,.6,.15,.06],t=[.2126,.7152,.0722],n=[.3127,.329];return s.define({[Ls]:{primaries:e,whitePoint:n,transfer:Ds,toXYZ:fa,fromXYZ:pa,luminanceCoefficients:t,workingColorSpaceConfig:{unpackColorSpace:qt},outputColorSpaceConfig:{drawingBufferColorSpace:qt}},[qt]:{primaries:e,whitePoint:n,transfer:tt,toXYZ:fa,fromXYZ:pa,luminanceCoefficients:t,outputColorSpaceConfig:{drawingBufferColorSpace:qt}}}),s}const qe=Dl();function yn(s){return s<.04045?s*.0773993808:Math.pow(s*.9478672986+.0521327014,2.4)}function fi(s){return s<.0031308?s*12.92:1.055*Math.pow(s,.41666)-.055}let jn;class Nl{static getDataURL(e,t="image/png"){if(/^data:/i.test(e.src)||typeof HTMLCanvasElement>"u")return e.src;let n;if(e instanceof HTMLCanvasElement)n=e;else{jn===void 0&&(jn=Ns("canvas")),jn.width=e.width,jn.height=e.height;const i=jn.getContext("2d");e instanceof ImageData?i.putImageData(e,0,0):i.drawImage(e,0,0,e.width,e.height),n=jn}return n.toDataURL(t)}static sRGBToLinear(e){if(typeof HTMLImageElement<"u"&&e instanceof HTMLImageElement||typeof HTMLCanvasElement<"u"&&e instanceof HTMLCanvasElement||typeof ImageBitmap<"u"&&e instanceof ImageBitmap){const t=Ns("canvas");t.width=e.width,t.height=e.height;const n=t.getContext("2d");n.drawImage(e,0,0,e.width,e.height);const i=n.getImageData(0,0,e.width,e.height),r=i.data;for(let a=0;a<r.length;a++)r[a]=yn(r[a]/255)*255;return n.putImageData(i,0,0),t}else if(e.data){const t=e.data.slice(0);for(let n=0;n<t.length;n++)t instanceof Uint8Array||t instanceof Uint8ClampedArray?t[n]=Math.floor(yn(t[n]/255)*255):t[n]=yn(t[n]);return{data:t,width:e.width,height:e.height}}else return Le("ImageUtils.sRGBToLinear(): Unsupported image type. No color space conversion applied."),e}}let Fl=0;class zr{constructor(e=null){this.isTextureSource=!0,Object.defineProperty(this,"id",{value:Fl++}),this.uuid=zi(),this.data=e,this.dataReady=!0,this.version=0}getSize(e){const t=this.data;return typeof HTMLVideoElement<"u"&&t instanceof HTMLVideoElement?e.set(t.videoWidth,t.videoHeight,0):typeof VideoFrame<"u"&&t instanceof VideoFrame?e.set(t.displayWidth,t.displayHeight,0):t!==null?e.set(t.width||0,t.height||0,t.depth||0):e.set(0,0,0),e}set needsUpdate(e){e===!0&&this.version++}toJSON(e){const t=e===void 0||typeof e=="string";if(!t&&e.images[this.uuid]!==void 0)return e.images[this.uuid];const n={uuid:this.uuid,url:""},i=this.data;if(i!==null){let r;if(Array.isArray(i)){r=[];for(let a=0,o=i.length;a<o;a++)i[a].isDataTexture?r.push(nr(i[a].image)):r.push(nr(i[a]))}else r=nr(i);n.url=r}return t||(e.images[this.uuid]=n),n}}function nr(s){return typeof HTMLImageElement<"u"&&s instanceof HTMLImageElement||typeof HTMLCanvasElement<"u"&&s instanceof HTMLCanvasElement||typeof ImageBitmap<"u"&&s instanceof ImageBitmap?Nl.getDataURL(s):s.data?{data:Array.from(s.data),width:s.width,height:s.height,type:s.data.constructor.name}:(Le("Texture: Unable to serialize Texture."),{})}let Il=0;const ir=new D;class Ft extends Jn{constructor(e=Ft.DEFAULT_IMAGE,t=Ft.DEFAULT_MAPPING,n=1001,i=1001,r=1006,a=1008,o=1023,l=1009,c=Ft.DEFAULT_ANISOTROPY,h=""){super(),this.isTexture=!0,Object.defineProperty(this,"id",{value:Il++}),this.uuid=zi(),this.name="",this.source=new zr(e),this.mipmaps=[],this.mapping=t,this.channel=0,this.wrapS=n,this.wrapT=i,this.magFilter=r,this.minFilter=a,this.anisotropy=c,this.format=o,this.internalFormat=null,this.type=l,this.offset=new Ye(0,0),this.repeat=new Ye(1,1),this.center=new Ye(0,0),this.rotation=0,this.matrixAutoUpdate=!0,this.matrix=new Ue,this.generateMipmaps=!0,this.mipmapsAutoUpdate=!0,this.premultiplyAlpha=!1,this.flipY=!0,this.unpackAlignment=4,this.colorSpace=h,this.userData={},this.updateRanges=[],this.version=0,this.onUpdate=null,this.renderTarget=null,this.isRenderTargetTexture=!1,this.isArrayTexture=!!(e&&e.depth&&e.depth>1),this.pmremVersion=0,this.isPMREMTexture=!1,this.normalized=!1}get width(){return this.source.getSize(ir).x}get height(){return this.source.getSize(ir).y}get depth(){return this.source.getSize(ir).z}get image(){return this.source.data}set image(e){this.source.data=e}updateMatrix(){this.matrix.setUvTransform(this.offset.x,this.offset.y,this.repeat.x,this.repeat.y,this.rotation,this.center.x,this.center.y)}addUpdateRange(e,t){this.updateRanges.push({start:e,count:t})}clearUpdateRanges(){this.updateRanges.length=0}clone(){return new this.constructor().copy(this)}copy(e){return this.name=e.name,this.source=e.source,this.mipmaps=e.mipmaps.slice(0),this.mapping=e.mapping,this.channel=e.channel,this.wrapS=e.wrapS,this.wrapT=e.wrapT,this.magFilter=e.magFilter,this.minFilter=e.minFilter,this.anisotropy=e.anisotropy,this.format=e.format,this.internalFormat=e.internalFormat,this.type=e.type,this.normalized=e.normalized,this.offset.copy(e.offset),this.repeat.copy(e.repeat),this.center.copy(e.center),this.rotation=e.rotation,this.matrixAutoUpdate=e.matrixAutoUpdate,this.matrix.copy(e.matrix),this.generateMipmaps=e.generateMipmaps,this.mipmapsAutoUpdate=e.mipmapsAutoUpdate,this.premultiplyAlpha=e.premultiplyAlpha,this.flipY=e.flipY,this.unpackAlignment=e.unpackAlignment,this.colorSpace=e.colorSpace,this.renderTarget=e.renderTarget,this.isRenderTargetTexture=e.isRenderTargetTexture,this.isPMREMTexture=e.isPMREMTexture,this.isArrayTexture=e.isArrayTexture,this.userData=JSON.parse(JSON.stringify(e.userData)),this.needsUpdate=!0,this}setValues(e){for(const t in e){const n=e[t];if(n===void 0){Le(`Texture.setValues(): parameter '${t}' has value of undefined.`);continue}const i=this[t];if(i===void 0){Le(`Texture.setValues(): property '${t}' does not exist.`);continue}i&&n&&i.isVector2&&n.isVector2||i&&n&&i.isVector3&&n.isVector3||i&&n&&i.isMatrix3&&n.isMatrix3?i.copy(n):this[t]=n}}toJSON(e){const t=e===void 0||typeof e=="string";if(!t&&e.textures[this.uuid]!==void 0)return e.textures[this.uuid];const n={metadata:{version:4.7,type:"Texture",generator:"Texture.toJSON"},uuid:this.uuid,name:this.name,image:this.source.toJSON(e).uuid,mapping:this.mapping,channel:this.channel,repeat:[this.repeat.x,this.repeat.y],offset:[this.offset.x,this.offset.y],center:[this.center.x,this.center.y],rotation:this.rotation,wrap:[this.wrapS,this.wrapT],format:this.format,internalFormat:this.internalFormat,type:this.type,normalized:this.normalized,colorSpace:this.colorSpace,minFilter:this.minFilter,magFilter:this.magFilter,anisotropy:this.anisotropy,flipY:this.flipY,generateMipmaps:this.generateMipmaps,mipmapsAutoUpdate:this.mipmapsAutoUpdate,premultiplyAlpha:this.premultiplyAlpha,unpackAlignment:this.unpackAlignment};return Object.keys(this.userData).length>0&&(n.userData=this.userData),t||(e.textures[this.uuid]=n),n}dispose(){this.dispatchEvent({type:"dispose"})}transformUv(e){if(this.mapping!==300)return e;if(e.applyMatrix3(this.matrix),e.x<0||e.x>1)switch(this.wrapS){case 1e3:e.x=e.x-Math.floor(e.x);break;case 1001:e.x=e.x<0?0:1;break;case 1002:Math.abs(Math.floor(e.x)%2)===1?e.x=Math.ceil(e.x)-e.x:e.x=e.x-Math.floor(e.x);break}if(e.y<0||e.y>1)switch(this.wrapT){case 1e3:e.y=e.y-Math.floor(e.y);break;case 1001:e.y=e.y<0?0:1;break;case 1002:Math.abs(Math.floor(e.y)%2)===1?e.y=Math.ceil(e.y)-e.y:e.y=e.y-Math.floor(e.y);break}return this.flipY&&(e.y=1-e.y),e}set needsUpdate(e){e===!0&&(this.version++,this.source.needsUpdate=!0)}set needsPMREMUpdate(e){e===!0&&this.pmremVersion++}}Ft.DEFAULT_IMAGE=null;Ft.DEFAULT_MAPPING=300;Ft.DEFAULT_ANISOTROPY=1;class gt{static{this.prototype.isVector4=!0}constructor(e=0,t=0,n=0,i=1){this.x=e,this.y=t,this.z=n,this.w=i}get width(){return this.z}set width(e){this.z=e}get height(){return this.w}set height(e){this.w=e}set(e,t,n,i){return this.x=e,this.y=t,this.z=n,this.w=i,this}setScalar(e){return this.x=e,this.y=e,this.z=e,this.w=e,this}setX(e){return this.x=e,this}setY(e){return this.y=e,this}setZ(e){return this.z=e,this}setW(e){return this.w=e,this}setComponent(e,t){switch(e){case 0:this.x=t;break;case 1:this.y=t;break;case 2:this.z=t;break;case 3:this.w=t;break;default:throw new Error("THREE.Vector4: index is out of range: "+e)}return this}getComponent(e){switch(e){case 0:return this.x;case 1:return this.y;case 2:return this.z;case 3:return this.w;default:throw new Error("THREE.Vector4: index is out of range: "+e)}}clone(){return new this.constructor(this.x,this.y,this.z,this.w)}copy(e){return this.x=e.x,this.y=e.y,this.z=e.z,this.w=e.w!==void 0?e.w:1,this}add(e){return this.x+=e.x,this.y+=e.y,this.z+=e.z,this.w+=e.w,this}addScalar(e){return this.x+=e,this.y+=e,this.z+=e,this.w+=e,this}addVectors(e,t){return this.x=e.x+t.x,this.y=e.y+t.y,this.z=e.z+t.z,this.w=e.w+t.w,this}addScaledVector(e,t){return this.x+=e.x*t,this.y+=e.y*t,this.z+=e.z*t,this.w+=e.w*t,this}sub(e){return this.x-=e.x,this.y-=e.y,this.z-=e.z,this.w-=e.w,this}subScalar(e){return this.x-=e,this.y-=e,this.z-=e,this.w-=e,this}subVectors(e,t){return this.x=e.x-t.x,this.y=e.y-t.y,this.z=e.z-t.z,this.w=e.w-t.w,this}multiply(e){return this.x*=e.x,this.y*=e.y,this.z*=e.z,this.w*=e.w,this}multiplyScalar(e){return this.x*=e,this.y*=e,this.z*=e,this.w*=e,this}applyMatrix4(e){const t=this.x,n=this.y,i=this.z,r=this.w,a=e.elements;return this.x=a[0]*t+a[4]*n+a[8]*i+a[12]*r,this.y=a[1]*t+a[5]*n+a[9]*i+a[13]*r,this.z=a[2]*t+a[6]*n+a[10]*i+a[14]*r,this.w=a[3]*t+a[7]*n+a[11]*i+a[15]*r,this}divide(e){return this.x/=e.x,this.y/=e.y,this.z/=e.z,this.w/=e.w,this}divideScalar(e){return this.multiplyScalar(1/e)}setAxisAngleFromQuaternion(e){this.w=2*Math.acos(e.w);const t=Math.sqrt(1-e.w*e.w);return t<1e-4?(this.x=1,this.y=0,this.z=0):(this.x=e.x/t,this.y=e.y/t,this.z=e.z/t),this}setAxisAngleFromRotationMatrix(e){let t,n,i,r;const l=e.elements,c=l[0],h=l[4],u=l[8],d=l[1],f=l[5],g=l[9],S=l[2],m=l[6],p=l[10];if(Math.abs(h-d)<.01&&Math.abs(u-S)<.01&&Math.abs(g-m)<.01){if(Math.abs(h+d)<.1&&Math.abs(u+S)<.1&&Math.abs(g+m)<.1&&Math.abs(c+f+p-3)<.1)return this.set(1,0,0,0),this;t=Math.PI;const A=(c+1)/2,b=(f+1)/2,R=(p+1)/2,E=(h+d)/4,_=(u+S)/4,y=(g+m)/4;return A>b&&A>R?A<.01?(n=0,i=.707106781,r=.707106781):(n=Math.sqrt(A),i=E/n,r=_/n):b>R?b<.01?(n=.707106781,i=0,r=.707106781):(i=Math.sqrt(b),n=E/i,r=y/i):R<.01?(n=.707106781,i=.707106781,r=0):(r=Math.sqrt(R),n=_/r,i=y/r),this.set(n,i,r,t),this}let M=Math.sqrt((m-g)*(m-g)+(u-S)*(u-S)+(d-h)*(d-h));return Math.abs(M)<.001&&(M=1),this.x=(m-g)/M,this.y=(u-S)/M,this.z=(d-h)/M,this.w=Math.acos((c+f+p-1)/2),this}setFromMatrixPosition(e){const t=e.elements;return this.x=t[12],this.y=t[13],this.z=t[14],this.w=t[15],this}min(e){return this.x=Math.min(this.x,e.x),this.y=Math.min(this.y,e.y),this.z=Math.min(this.z,e.z),this.w=Math.min(this.w,e.w),this}max(e){return this.x=Math.max(this.x,e.x),this.y=Math.max(this.y,e.y),this.z=Math.max(this.z,e.z),this.w=Math.max(this.w,e.w),this}clamp(e,t){return this.x=ze(this.x,e.x,t.x),this.y=ze(this.y,e.y,t.y),this.z=ze(this.z,e.z,t.z),this.w=ze(this.w,e.w,t.w),this}clampScalar(e,t){return this.x=ze(this.x,e,t),this.y=ze(this.y,e,t),this.z=ze(this.z,e,t),this.w=ze(this.w,e,t),this}clampLength(e,t){const n=this.length();return this.divideScalar(n||1).multiplyScalar(ze(n,e,t))}floor(){return this.x=Math.floor(this.x),this.y=Math.floor(this.y),this.z=Math.floor(this.z),this.w=Math.floor(this.w),this}ceil(){return this.x=Math.ceil(this.x),this.y=Math.ceil(this.y),this.z=Math.ceil(this.z),this.w=Math.ceil(this.w),this}round(){return this.x=Math.round(this.x),this.y=Math.round(this.y),this.z=Math.round(this.z),this.w=Math.round(this.w),this}roundToZero(){return this.x=Math.trunc(this.x),this.y=Math.trunc(this.y),this.z=Math.trunc(this.z),this.w=Math.trunc(this.w),this}negate(){return this.x=-this.x,this.y=-this.y,this.z=-this.z,this.w=-this.w,this}dot(e){return this.x*e.x+this.y*e.y+this.z*e.z+this.w*e.w}lengthSq(){return this.x*this.x+this.y*this.y+this.z*this.z+this.w*this.w}length(){return Math.sqrt(this.x*this.x+this.y*this.y+this.z*this.z+this.w*this.w)}manhattanLength(){return Math.abs(this.x)+Math.abs(this.y)+Math.abs(this.z)+Math.abs(this.w)}normalize(){return this.divideScalar(this.length()||1)}setLength(e){return this.normalize().multiplyScalar(e)}lerp(e,t){return this.x+=(e.x-this.x)*t,this.y+=(e.y-this.y)*t,this.z+=(e.z-this.z)*t,this.w+=(e.w-this.w)*t,this}lerpVectors(e,t,n){return this.x=e.x+(t.x-e.x)*n,this.y=e.y+(t.y-e.y)*n,this.z=e.z+(t.z-e.z)*n,this.w=e.w+(t.w-e.w)*n,this}equals(e){return e.x===this.x&&e.y===this.y&&e.z===this.z&&e.w===this.w}fromArray(e,t=0){return this.x=e[t],this.y=e[t+1],this.z=e[t+2],this.w=e[t+3],this}toArray(e=[],t=0){return e[t]=this.x,e[t+1]=this.y,e[t+2]=this.z,e[t+3]=this.w,e}fromBufferAttribute(e,t){return this.x=e.getX(t),this.y=e.getY(t),this.z=e.getZ(t),this.w=e.getW(t),this}random(){return this.x=Math.random(),this.y=Math.random(),this.z=Math.random(),this.w=Math.random(),this}*[Symbol.iterator](){yield this.x,yield this.y,yield this.z,yield this.w}}class Ul extends Jn{constructor(e=1,t=1,n={}){super(),n=Object.assign({generateMipmaps:!1,internalFormat:null,minFilter:1006,depthBuffer:!0,stencilBuffer:!1,resolveColorBuffer:!0,resolveDepthBuffer:!0,resolveStencilBuffer:!0,storeMultisampledColorBuffer:!0,storeMultisampledDepthBuffer:!0,storeMultisampledStencilBuffer:!0,depthTexture:null,samples:0,count:1,depth:1,multiview:!1,useArrayDepthTexture:!1},n),this.isRenderTarget=!0,this.width=e,this.height=t,this.depth=n.depth,this.scissor=new gt(0,0,e,t),this.scissorTest=!1,this.viewport=new gt(0,0,e,t),this.textures=[];const i=n.count;for(let r=0;r<i;r++)this.textures[r]=new Ft({width:e,height:t,depth:n.depth}),this.textures[r].isRenderTargetTexture=!0,this.textures[r].renderTarget=this;this._setTextureOptions(n),this.depthBuffer=n.depthBuffer,this.stencilBuffer=n.stencilBuffer,this.resolveColorBuffer=n.resolveColorBuffer,this.resolveDepthBuffer=n.resolveDepthBuffer,this.resolveStencilBuffer=n.resolveStencilBuffer,this.storeMultisampledColorBuffer=n.storeMultisampledColorBuffer,this.storeMultisampledDepthBuffer=n.storeMultisampledDepthBuffer,this.storeMultisampledStencilBuffer=n.storeMultisampledStencilBuffer,this._depthTexture=null,this.depthTexture=n.depthTexture,this.samples=n.samples,this.multiview=n.multiview,this.useArrayDepthTexture=n.useArrayDepthTexture}_setTextureOptions(e={}){const t={minFilter:1006,generateMipmaps:!1,flipY:!1,internalFormat:null};e.mapping!==void 0&&(t.mapping=e.mapping),e.wrapS!==void 0&&(t.wrapS=e.wrapS),e.wrapT!==void 0&&(t.wrapT=e.wrapT),e.wrapR!==void 0&&(t.wrapR=e.wrapR),e.magFilter!==void 0&&(t.magFilter=e.magFilter),e.minFilter!==void 0&&(t.minFilter=e.minFilter),e.format!==void 0&&(t.format=e.format),e.type!==void 0&&(t.type=e.type),e.anisotropy!==void 0&&(t.anisotropy=e.anisotropy),e.colorSpace!==void 0&&(t.colorSpace=e.colorSpace),e.flipY!==void 0&&(t.flipY=e.flipY),e.generateMipmaps!==void 0&&(t.generateMipmaps=e.generateMipmaps),e.mipmapsAutoUpdate!==void 0&&(t.mipmapsAutoUpdate=e.mipmapsAutoUpdate),e.internalFormat!==void 0&&(t.internalFormat=e.internalFormat);for(let n=0;n<this.textures.length;n++)this.textures[n].setValues(t)}get texture(){return this.textures[0]}set texture(e){this.textures[0]=e}set depthTexture(e){this._depthTexture!==null&&this._depthTexture.renderTarget===this&&(this._depthTexture.renderTarget=null),e!==null&&e.renderTarget===null&&(e.renderTarget=this),this._depthTexture=e}get depthTexture(){return this._depthTexture}setSize(e,t,n=1){if(this.width!==e||this.height!==t||this.depth!==n){this.width=e,this.height=t,this.depth=n;for(let i=0,r=this.textures.length;i<r;i++)this.textures[i].image.width=e,this.textures[i].image.height=t,this.textures[i].image.depth=n,this.textures[i].isData3DTexture!==!0&&(this.textures[i].isArrayTexture=this.textures[i].image.depth>1);this.dispose()}this.viewport.set(0,0,e,t),this.scissor.set(0,0,e,t)}clone(){return new this.constructor().copy(this)}copy(e){this.width=e.width,this.height=e.height,this.depth=e.depth,this.scissor.copy(e.scissor),this.scissorTest=e.scissorTest,this.viewport.copy(e.viewport),this.textures.length=0;for(let t=0,n=e.textures.length;t<n;t++){this.textures[t]=e.textures[t].clone(),this.textures[t].isRenderTargetTexture=!0,this.textures[t].renderTarget=this;const i=Object.assign({},e.textures[t].image);this.textures[t].source=new zr(i)}if(this.depthBuffer=e.depthBuffer,this.stencilBuffer=e.stencilBuffer,this.resolveColorBuffer=e.resolveColorBuffer,this.resolveDepthBuffer=e.resolveDepthBuffer,this.resolveStencilBuffer=e.resolveStencilBuffer,this.storeMultisampledColorBuffer=e.storeMultisampledColorBuffer,this.storeMultisampledDepthBuffer=e.storeMultisampledDepthBuffer,this.storeMultisampledStencilBuffer=e.storeMultisampledStencilBuffer,e.depthTexture!==null)if(e.depthTexture.renderTarget===e){const t=e.depthTexture.clone();t.renderTarget=null,this.depthTexture=t}else this.depthTexture=e.depthTexture;else this.depthTexture=null;return this.samples=e.samples,this.multiview=e.multiview,this.useArrayDepthTexture=e.useArrayDepthTexture,this}dispose(){this.dispatchEvent({type:"dispose"})}}class Zt extends Ul{constructor(e=1,t=1,n={}){super(e,t,n),this.isWebGLRenderTarget=!0}}class Co extends Ft{constructor(e=null,t=1,n=1,i=1){super(null),this.isDataArrayTexture=!0,this.image={data:e,width:t,height:n,depth:i},this.magFilter=1003,this.minFilter=1003,this.wrapR=1001,this.generateMipmaps=!1,this.flipY=!1,this.unpackAlignment=1,this.layerUpdates=new Set}copy(e){return super.copy(e),this.wrapR=e.wrapR,this}addLayerUpdate(e){this.layerUpdates.add(e)}clearLayerUpdates(){this.layerUpdates.clear()}}class Ol extends Ft{constructor(e=null,t=1,n=1,i=1){super(null),this.isData3DTexture=!0,this.image={data:e,width:t,height:n,depth:i},this.magFilter=1003,this.minFilter=1003,this.wrapR=1001,this.generateMipmaps=!1,this.flipY=!1,this.unpackAlignment=1}copy(e){return super.copy(e),this.wrapR=e.wrapR,this}}class Qe{static{this.prototype.isMatrix4=!0}constructor(e,t,n,i,r,a,o,l,c,h,u,d,f,g,S,m){this.elements=[1,0,0,0,0,1,0,0,0,0,1,0,0,0,0,1],e!==void 0&&this.set(e,t,n,i,r,a,o,l,c,h,u,d,f,g,S,m)}set(e,t,n,i,r,a,o,l,c,h,u,d,f,g,S,m){const p=this.elements;return p[0]=e,p[4]=t,p[8]=n,p[12]=i,p[1]=r,p[5]=a,p[9]=o,p[13]=l,p[2]=c,p[6]=h,p[10]=u,p[14]=d,p[3]=f,p[7]=g,p[11]=S,p[15]=m,this}identity(){return this.set(1,0,0,0,0,1,0,0,0,0,1,0,0,0,0,1),this}clone(){return new Qe().fromArray(this.elements)}copy(e){const t=this.elements,n=e.elements;return t[0]=n[0],t[1]=n[1],t[2]=n[2],t[3]=n[3],t[4]=n[4],t[5]=n[5],t[6]=n[6],t[7]=n[7],t[8]=n[8],t[9]=n[9],t[10]=n[10],t[11]=n[11],t[12]=n[12],t[13]=n[13],t[14]=n[14],t[15]=n[15],this}copyPosition(e){const t=this.elements,n=e.elements;return t[12]=n[12],t[13]=n[13],t[14]=n[14],this}setFromMatrix3(e){const t=e.elements;return this.set(t[0],t[3],t[6],0,t[1],t[4],t[7],0,t[2],t[5],t[8],0,0,0,0,1),this}extractBasis(e,t,n){return this.determinantAffine()===0?(e.set(1,0,0),t.set(0,1,0),n.set(0,0,1),this):(e.setFromMatrixColumn(this,0),t.setFromMatrixColumn(this,1),n.setFromMatrixColumn(this,2),this)}makeBasis(e,t,n){return this.set(e.x,t.x,n.x,0,e.y,t.y,n.y,0,e.z,t.z,n.z,0,0,0,0,1),this}extractRotation(e){if(e.determinantAffine()===0)return this.identity();const t=this.elements,n=e.elements,i=1/ei.setFromMatrixColumn(e,0).length(),r=1/ei.setFromMatrixColumn(e,1).length(),a=1/ei.setFromMatrixColumn(e,2).length();return t[0]=n[0]*i,t[1]=n[1]*i,t[2]=n[2]*i,t[3]=0,t[4]=n[4]*r,t[5]=n[5]*r,t[6]=n[6]*r,t[7]=0,t[8]=n[8]*a,t[9]=n[9]*a,t[10]=n[10]*a,t[11]=0,t[12]=0,t[13]=0,t[14]=0,t[15]=1,this}makeRotationFromEuler(e){const t=this.elements,n=e.x,i=e.y,r=e.z,a=Math.cos(n),o=Math.sin(n),l=Math.cos(i),c=Math.sin(i),h=Math.cos(r),u=Math.sin(r);if(e.order==="XYZ"){const d=a*h,f=a*u,g=o*h,S=o*u;t[0]=l*h,t[4]=-l*u,t[8]=c,t[1]=f+g*c,t[5]=d-S*c,t[9]=-o*l,t[2]=S-d*c,t[6]=g+f*c,t[10]=a*l}else if(e.order==="YXZ"){const d=l*h,f=l*u,g=c*h,S=c*u;t[0]=d+S*o,t[4]=g*o-f,t[8]=a*c,t[1]=a*u,t[5]=a*h,t[9]=-o,t[2]=f*o-g,t[6]=S+d*o,t[10]=a*l}else if(e.order==="ZXY"){const d=l*h,f=l*u,g=c*h,S=c*u;t[0]=d-S*o,t[4]=-a*u,t[8]=g+f*o,t[1]=f+g*o,t[5]=a*h,t[9]=S-d*o,t[2]=-a*c,t[6]=o,t[10]=a*l}else if(e.order==="ZYX"){const d=a*h,f=a*u,g=o*h,S=o*u;t[0]=l*h,t[4]=g*c-f,t[8]=d*c+S,t[1]=l*u,t[5]=S*c+d,t[9]=f*c-g,t[2]=-c,t[6]=o*l,t[10]=a*l}else if(e.order==="YZX"){const d=a*l,f=a*c,g=o*l,S=o*c;t[0]=l*h,t[4]=S-d*u,t[8]=g*u+f,t[1]=u,t[5]=a*h,t[9]=-o*h,t[2]=-c*h,t[6]=f*u+g,t[10]=d-S*u}else if(e.order==="XZY"){const d=a*l,f=a*c,g=o*l,S=o*c;t[0]=l*h,t[4]=-u,t[8]=c*h,t[1]=d*u+S,t[5]=a*h,t[9]=f*u-g,t[2]=g*u-f,t[6]=o*h,t[10]=S*u+d}return t[3]=0,t[7]=0,t[11]=0,t[12]=0,t[13]=0,t[14]=0,t[15]=1,this}makeRotationFromQuaternion(e){return this.compose(Bl,e,kl)}lookAt(e,t,n){const i=this.elements;return kt.subVectors(e,t),kt.lengthSq()===0&&(kt.z=1),kt.normalize(),Cn.crossVectors(n,kt),Cn.lengthSq()===0&&(Math.abs(n.z)===1?kt.x+=1e-4:kt.z+=1e-4,kt.normalize(),Cn.crossVectors(n,kt)),Cn.normalize(),$i.crossVectors(kt,Cn),i[0]=Cn.x,i[4]=$i.x,i[8]=kt.x,i[1]=Cn.y,i[5]=$i.y,i[9]=kt.y,i[2]=Cn.z,i[6]=$i.z,i[10]=kt.z,this}multiply(e){return this.multiplyMatrices(this,e)}premultiply(e){return this.multiplyMatrices(e,this)}multiplyMatrices(e,t){const n=e.elements,i=t.elements,r=this.elements,a=n[0],o=n[4],l=n[8],c=n[12],h=n[1],u=n[5],d=n[9],f=n[13],g=n[2],S=n[6],m=n[10],p=n[14],M=n[3],A=n[7],b=n[11],R=n[15],E=i[0],_=i[4],y=i[8],k=i[12],N=i[1],I=i[5],z=i[9],$=i[13],P=i[2],W=i[6],Z=i[10],H=i[14],te=i[3],V=i[7],j=i[11],ee=i[15];return r[0]=a*E+o*N+l*P+c*te,r[4]=a*_+o*I+l*W+c*V,r[8]=a*y+o*z+l*Z+c*j,r[12]=a*k+o*$+l*H+c*ee,r[1]=h*E+u*N+d*P+f*te,r[5]=h*_+u*I+d*W+f*V,r[9]=h*y+u*z+d*Z+f*j,r[13]=h*k+u*$+d*H+f*ee,r[2]=g*E+S*N+m*P+p*te,r[6]=g*_+S*I+m*W+p*V,r[10]=g*y+S*z+m*Z+p*j,r[14]=g*k+S*$+m*H+p*ee,r[3]=M*E+A*N+b*P+R*te,r[7]=M*_+A*I+b*W+R*V,r[11]=M*y+A*z+b*Z+R*j,r[15]=M*k+A*$+b*H+R*ee,this}multiplyScalar(e){const t=this.elements;return t[0]*=e,t[4]*=e,t[8]*=e,t[12]*=e,t[1]*=e,t[5]*=e,t[9]*=e,t[13]*=e,t[2]*=e,t[6]*=e,t[10]*=e,t[14]*=e,t[3]*=e,t[7]*=e,t[11]*=e,t[15]*=e,this}determinant(){const e=this.elements,t=e[0],n=e[4],i=e[8],r=e[12],a=e[1],o=e[5],l=e[9],c=e[13],h=e[2],u=e[6],d=e[10],f=e[14],g=e[3],S=e[7],m=e[11],p=e[15],M=l*f-c*d,A=o*f-c*u,b=o*d-l*u,R=a*f-c*h,E=a*d-l*h,_=a*u-o*h;return t*(S*M-m*A+p*b)-n*(g*M-m*R+p*E)+i*(g*A-S*R+p*_)-r*(g*b-S*E+m*_)}determinantAffine(){const e=this.elements,t=e[0],n=e[4],i=e[8],r=e[1],a=e[5],o=e[9],l=e[2],c=e[6],h=e[10];return t*(a*h-o*c)-n*(r*h-o*l)+i*(r*c-a*l)}transpose(){const e=this.elements;let t;return t=e[1],e[1]=e[4],e[4]=t,t=e[2],e[2]=e[8],e[8]=t,t=e[6],e[6]=e[9],e[9]=t,t=e[3],e[3]=e[12],e[12]=t,t=e[7],e[7]=e[13],e[13]=t,t=e[11],e[11]=e[14],e[14]=t,this}setPosition(e,t,n){const i=this.elements;return e.isVector3?(i[12]=e.x,i[13]=e.y,i[14]=e.z):(i[12]=e,i[13]=t,i[14]=n),this}invert(){const e=this.elements,t=e[0],n=e[1],i=e[2],r=e[3],a=e[4],o=e[5],l=e[6],c=e[7],h=e[8],u=e[9],d=e[10],f=e[11],g=e[12],S=e[13],m=e[14],p=e[15],M=t*o-n*a,A=t*l-i*a,b=t*c-r*a,R=n*l-i*o,E=n*c-r*o,_=i*c-r*l,y=h*S-u*g,k=h*m-d*g,N=h*p-f*g,I=u*m-d*S,z=u*p-f*S,$=d*p-f*m,P=M*$-A*z+b*I+R*N-E*k+_*y;if(P===0)return this.set(0,0,0,0,0,0,0,0,0,0,0,0,0,0,0,0);const W=1/P;return e[0]=(o*$-l*z+c*I)*W,e[1]=(i*z-n*$-r*I)*W,e[2]=(S*_-m*E+p*R)*W,e[3]=(d*E-u*_-f*R)*W,e[4]=(l*N-a*$-c*k)*W,e[5]=(t*$-i*N+r*k)*W,e[6]=(m*b-g*_-p*A)*W,e[7]=(h*_-d*b+f*A)*W,e[8]=(a*z-o*N+c*y)*W,e[9]=(n*N-t*z-r*y)*W,e[10]=(g*E-S*b+p*M)*W,e[11]=(u*b-h*E-f*M)*W,e[12]=(o*k-a*I-l*y)*W,e[13]=(t*I-n*k+i*y)*W,e[14]=(S*A-g*R-m*M)*W,e[15]=(h*R-u*A+d*M)*W,this}scale(e){const t=this.elements,n=e.x,i=e.y,r=e.z;return t[0]*=n,t[4]*=i,t[8]*=r,t[1]*=n,t[5]*=i,t[9]*=r,t[2]*=n,t[6]*=i,t[10]*=r,t[3]*=n,t[7]*=i,t[11]*=r,this}getMaxScaleOnAxis(){const e=this.elements,t=e[0]*e[0]+e[1]*e[1]+e[2]*e[2],n=e[4]*e[4]+e[5]*e[5]+e[6]*e[6],i=e[8]*e[8]+e[9]*e[9]+e[10]*e[10];return Math.sqrt(Math.max(t,n,i))}makeTranslation(e,t,n){return e.isVector3?this.set(1,0,0,e.x,0,1,0,e.y,0,0,1,e.z,0,0,0,1):this.set(1,0,0,e,0,1,0,t,0,0,1,n,0,0,0,1),this}makeRotationX(e){const t=Math.cos(e),n=Math.sin(e);return this.set(1,0,0,0,0,t,-n,0,0,n,t,0,0,0,0,1),this}makeRotationY(e){const t=Math.cos(e),n=Math.sin(e);return this.set(t,0,n,0,0,1,0,0,-n,0,t,0,0,0,0,1),this}makeRotationZ(e){const t=Math.cos(e),n=Math.sin(e);return this.set(t,-n,0,0,n,t,0,0,0,0,1,0,0,0,0,1),this}makeRotationAxis(e,t){const n=Math.cos(t),i=Math.sin(t),r=1-n,a=e.x,o=e.y,l=e.z,c=r*a,h=r*o;return this.set(c*a+n,c*o-i*l,c*l+i*o,0,c*o+i*l,h*o+n,h*l-i*a,0,c*l-i*o,h*l+i*a,r*l*l+n,0,0,0,0,1),this}makeScale(e,t,n){return this.set(e,0,0,0,0,t,0,0,0,0,n,0,0,0,0,1),this}makeShear(e,t,n,i,r,a){return this.set(1,n,r,0,e,1,a,0,t,i,1,0,0,0,0,1),this}compose(e,t,n){const i=this.elements,r=t._x,a=t._y,o=t._z,l=t._w,c=r+r,h=a+a,u=o+o,d=r*c,f=r*h,g=r*u,S=a*h,m=a*u,p=o*u,M=l*c,A=l*h,b=l*u,R=n.x,E=n.y,_=n.z;return i[0]=(1-(S+p))*R,i[1]=(f+b)*R,i[2]=(g-A)*R,i[3]=0,i[4]=(f-b)*E,i[5]=(1-(d+p))*E,i[6]=(m+M)*E,i[7]=0,i[8]=(g+A)*_,i[9]=(m-M)*_,i[10]=(1-(d+S))*_,i[11]=0,i[12]=e.x,i[13]=e.y,i[14]=e.z,i[15]=1,this}decompose(e,t,n){const i=this.elements;e.x=i[12],e.y=i[13],e.z=i[14];const r=this.determinantAffine();if(r===0)return n.set(1,1,1),t.identity(),this;let a=ei.set(i[0],i[1],i[2]).length();const o=ei.set(i[4],i[5],i[6]).length(),l=ei.set(i[8],i[9],i[10]).length();r<0&&(a=-a),jt.copy(this);const c=1/a,h=1/o,u=1/l;return jt.elements[0]*=c,jt.elements[1]*=c,jt.elements[2]*=c,jt.elements[4]*=h,jt.elements[5]*=h,jt.elements[6]*=h,jt.elements[8]*=u,jt.elements[9]*=u,jt.elements[10]*=u,t.setFromRotationMatrix(jt),n.x=a,n.y=o,n.z=l,this}makePerspective(e,t,n,i,r,a,o=2e3,l=!1){const c=this.elements,h=2*r/(t-e),u=2*r/(n-i),d=(t+e)/(t-e),f=(n+i)/(n-i);let g,S;if(l)g=r/(a-r),S=a*r/(a-r);else if(o===2e3)g=-(a+r)/(a-r),S=-2*a*r/(a-r);else if(o===2001)g=-a/(a-r),S=-a*r/(a-r);else throw new Error("THREE.Matrix4.makePerspective(): Invalid coordinate system: "+o);return c[0]=h,c[4]=0,c[8]=d,c[12]=0,c[1]=0,c[5]=u,c[9]=f,c[13]=0,c[2]=0,c[6]=0,c[10]=g,c[14]=S,c[3]=0,c[7]=0,c[11]=-1,c[15]=0,this}makeOrthographic(e,t,n,i,r,a,o=2e3,l=!1){const c=this.elements,h=2/(t-e),u=2/(n-i),d=-(t+e)/(t-e),f=-(n+i)/(n-i);let g,S;if(l)g=1/(a-r),S=a/(a-r);else if(o===2e3)g=-2/(a-r),S=-(a+r)/(a-r);else if(o===2001)g=-1/(a-r),S=-r/(a-r);else throw new Error("THREE.Matrix4.makeOrthographic(): Invalid coordinate system: "+o);return c[0]=h,c[4]=0,c[8]=0,c[12]=d,c[1]=0,c[5]=u,c[9]=0,c[13]=f,c[2]=0,c[6]=0,c[10]=g,c[14]=S,c[3]=0,c[7]=0,c[11]=0,c[15]=1,this}equals(e){const t=this.elements,n=e.elements;for(let i=0;i<16;i++)if(t[i]!==n[i])return!1;return!0}fromArray(e,t=0){for(let n=0;n<16;n++)this.elements[n]=e[n+t];return this}toArray(e=[],t=0){const n=this.elements;return e[t]=n[0],e[t+1]=n[1],e[t+2]=n[2],e[t+3]=n[3],e[t+4]=n[4],e[t+5]=n[5],e[t+6]=n[6],e[t+7]=n[7],e[t+8]=n[8],e[t+9]=n[9],e[t+10]=n[10],e[t+11]=n[11],e[t+12]=n[12],e[t+13]=n[13],e[t+14]=n[14],e[t+15]=n[15],e}}const ei=new D,jt=new Qe,Bl=new D(0,0,0),kl=new D(1,1,1),Cn=new D,$i=new D,kt=new D,ma=new Qe,ga=new Un;class Yn{constructor(e=0,t=0,n=0,i=Yn.DEFAULT_ORDER){this.isEuler=!0,this._x=e,this._y=t,this._z=n,this._order=i}get x(){return this._x}set x(e){this._x=e,this._onChangeCallback()}get y(){return this._y}set y(e){this._y=e,this._onChangeCallback()}get z(){return this._z}set z(e){this._z=e,this._onChangeCallback()}get order(){return this._order}set order(e){this._order=e,this._onChangeCallback()}set(e,t,n,i=this._order){return this._x=e,this._y=t,this._z=n,this._order=i,this._onChangeCallback(),this}clone(){return new this.constructor(this._x,this._y,this._z,this._order)}copy(e){return this._x=e._x,this._y=e._y,this._z=e._z,this._order=e._order,this._onChangeCallback(),this}setFromRotationMatrix(e,t=this._order,n=!0){const i=e.elements,r=i[0],a=i[4],o=i[8],l=i[1],c=i[5],h=i[9],u=i[2],d=i[6],f=i[10];switch(t){case"XYZ":this._y=Math.asin(ze(o,-1,1)),Math.abs(o)<.9999999?(this._x=Math.atan2(-h,f),this._z=Math.atan2(-a,r)):(this._x=Math.atan2(d,c),this._z=0);break;case"YXZ":this._x=Math.asin(-ze(h,-1,1)),Math.abs(h)<.9999999?(this._y=Math.atan2(o,f),this._z=Math.atan2(l,c)):(this._y=Math.atan2(-u,r),this._z=0);break;case"ZXY":this._x=Math.asin(ze(d,-1,1)),Math.abs(d)<.9999999?(this._y=Math.atan2(-u,f),this._z=Math.atan2(-a,c)):(this._y=0,this._z=Math.atan2(l,r));break;case"ZYX":this._y=Math.asin(-ze(u,-1,1)),Math.abs(u)<.9999999?(this._x=Math.atan2(d,f),this._z=Math.atan2(l,r)):(this._x=0,this._z=Math.atan2(-a,c));break;case"YZX":this._z=Math.asin(ze(l,-1,1)),Math.abs(l)<.9999999?(this._x=Math.atan2(-h,c),this._y=Math.atan2(-u,r)):(this._x=0,this._y=Math.atan2(o,f));break;case"XZY":this._z=Math.asin(-ze(a,-1,1)),Math.abs(a)<.9999999?(this._x=Math.atan2(d,c),this._y=Math.atan2(o,r)):(this._x=Math.atan2(-h,f),this._y=0);break;default:Le("Euler: .setFromRotationMatrix() encountered an unknown order: "+t)}return this._order=t,n===!0&&this._onChangeCallback(),this}setFromQuaternion(e,t,n){return ma.makeRotationFromQuaternion(e),this.setFromRotationMatrix(ma,t,n)}setFromVector3(e,t=this._order){return this.set(e.x,e.y,e.z,t)}reorder(e){return ga.setFromEuler(this),this.setFromQuaternion(ga,e)}equals(e){return e._x===this._x&&e._y===this._y&&e._z===this._z&&e._order===this._order}fromArray(e){return this._x=e[0],this._y=e[1],this._z=e[2],e[3]!==void 0&&(this._order=e[3]),this._onChangeCallback(),this}toArray(e=[],t=0){return e[t]=this._x,e[t+1]=this._y,e[t+2]=this._z,e[t+3]=this._order,e}_onChange(e){return this._onChangeCallback=e,this}_onChangeCallback(){}*[Symbol.iterator](){yield this._x,yield this._y,yield this._z,yield this._order}}Yn.DEFAULT_ORDER="XYZ";class Hr{constructor(){this.mask=1}set(e){this.mask=(1<<e|0)>>>0}enable(e){this.mask|=1<<e|0}enableAll(){this.mask=-1}toggle(e){this.mask^=1<<e|0}disable(e){this.mask&=~(1<<e|0)}disableAll(){this.mask=0}test(e){return(this.mask&e.mask)!==0}isEnabled(e){return(this.mask&(1<<e|0))!==0}}let Gl=0;const _a=new D,ti=new Un,_n=new Qe,qi=new D,Ei=new D,zl=new D,Hl=new Un,va=new D(1,0,0),xa=new D(0,1,0),Sa=new D(0,0,1),Ma={type:"added"},Vl={type:"removed"},ni={type:"childadded",child:null},sr={type:"childremoved",child:null};class It extends Jn{constructor(){super(),this.isObject3D=!0,Object.defineProperty(this,"id",{value:Gl++}),this.uuid=zi(),this.name="",this.type="Object3D",this.parent=null,this.children=[],this.up=It.DEFAULT_UP.clone();const e=new D,t=new Yn,n=new Un,i=new D(1,1,1);function r(){n.setFromEuler(t,!1)}function a(){t.setFromQuaternion(n,void 0,!1)}t._onChange(r),n._onChange(a),Object.defineProperties(this,{position:{configurable:!0,enumerable:!0,value:e},rotation:{configurable:!0,enumerable:!0,value:t},quaternion:{configurable:!0,enumerable:!0,value:n},scale:{configurable:!0,enumerable:!0,value:i},modelViewMatrix:{value:new Qe},normalMatrix:{value:new Ue}}),this.matrix=new Qe,this.matrixWorld=new Qe,this.matrixAutoUpdate=It.DEFAULT_MATRIX_AUTO_UPDATE,this.matrixWorldAutoUpdate=It.DEFAULT_MATRIX_WORLD_AUTO_UPDATE,this.matrixWorldNeedsUpdate=!1,this.layers=new Hr,this.visible=!0,this.castShadow=!1,this.receiveShadow=!1,this.frustumCulled=!0,this.renderOrder=0,this.animations=[],this.customDepthMaterial=void 0,this.customDistanceMaterial=void 0,this.static=!1,this.userData={},this.pivot=null}onBeforeShadow(){}onAfterShadow(){}onBeforeRender(){}onAfterRender(){}applyMatrix4(e){this.matrixAutoUpdate&&this.updateMatrix(),this.matrix.premultiply(e),this.matrix.decompose(this.position,this.quaternion,this.scale),this.pivot!==null&&this.position.copy(this.pivot).applyMatrix4(this.matrix).sub(this.pivot)}applyQuaternion(e){return this.quaternion.premultiply(e),this}setRotationFromAxisAngle(e,t){this.quaternion.setFromAxisAngle(e,t)}setRotationFromEuler(e){this.quaternion.setFromEuler(e,!0)}setRotationFromMatrix(e){this.quaternion.setFromRotationMatrix(e)}setRotationFromQuaternion(e){this.quaternion.copy(e)}rotateOnAxis(e,t){return ti.setFromAxisAngle(e,t),this.quaternion.multiply(ti),this}rotateOnWorldAxis(e,t){return ti.setFromAxisAngle(e,t),this.quaternion.premultiply(ti),this}rotateX(e){return this.rotateOnAxis(va,e)}rotateY(e){return this.rotateOnAxis(xa,e)}rotateZ(e){return this.rotateOnAxis(Sa,e)}translateOnAxis(e,t){return _a.copy(e).applyQuaternion(this.quaternion),this.position.add(_a.multiplyScalar(t)),this}translateX(e){return this.translateOnAxis(va,e)}translateY(e){return this.translateOnAxis(xa,e)}translateZ(e){return this.translateOnAxis(Sa,e)}localToWorld(e){return this.updateWorldMatrix(!0,!1),e.applyMatrix4(this.matrixWorld)}worldToLocal(e){return this.updateWorldMatrix(!0,!1),e.applyMatrix4(_n.copy(this.matrixWorld).invert())}lookAt(e,t,n){e.isVector3?qi.copy(e):qi.set(e,t,n);const i=this.parent;this.updateWorldMatrix(!0,!1),Ei.setFromMatrixPosition(this.matrixWorld),this.isCamera||this.isLight?_n.lookAt(Ei,qi,this.up):_n.lookAt(qi,Ei,this.up),this.quaternion.setFromRotationMatrix(_n),i&&(_n.extractRotation(i.matrixWorld),ti.setFromRotationMatrix(_n),this.quaternion.premultiply(ti.invert()))}add(e){if(arguments.length>1){for(let t=0;t<arguments.length;t++)this.add(arguments[t]);return this}return e===this?(Je("Object3D.add: object can't be added as a child of itself.",e),this):(e&&e.isObject3D?(e.removeFromParent(),e.parent=this,this.children.push(e),e.dispatchEvent(Ma),ni.child=e,this.dispatchEvent(ni),ni.child=null):Je("Object3D.add: object not an instance of THREE.Object3D.",e),this)}remove(e){if(arguments.length>1){for(let n=0;n<arguments.length;n++)this.remove(arguments[n]);return this}const t=this.children.indexOf(e);return t!==-1&&(e.parent=null,this.children.splice(t,1),e.dispatchEvent(Vl),sr.child=e,this.dispatchEvent(sr),sr.child=null),this}removeFromParent(){const e=this.parent;return e!==null&&e.remove(this),this}clear(){return this.remove(...this.children)}attach(e){return this.updateWorldMatrix(!0,!1),_n.copy(this.matrixWorld).invert(),e.parent!==null&&(e.parent.updateWorldMatrix(!0,!1),_n.multiply(e.parent.matrixWorld)),e.applyMatrix4(_n),e.removeFromParent(),e.parent=this,this.children.push(e),e.updateWorldMatrix(!1,!0),e.dispatchEvent(Ma),ni.child=e,this.dispatchEvent(ni),ni.child=null,this}getObjectById(e){return this.getObjectByProperty("id",e)}getObjectByName(e){return this.getObjectByProperty("name",e)}getObjectByProperty(e,t){if(this[e]===t)return this;for(let n=0,i=this.children.length;n<i;n++){const a=this.children[n].getObjectByProperty(e,t);if(a!==void 0)return a}}getObjectsByProperty(e,t,n=[]){this[e]===t&&n.push(this);const i=this.children;for(let r=0,a=i.length;r<a;r++)i[r].getObjectsByProperty(e,t,n);return n}getWorldPosition(e){return this.updateWorldMatrix(!0,!1),e.setFromMatrixPosition(this.matrixWorld)}getWorldQuaternion(e){return this.updateWorldMatrix(!0,!1),this.matrixWorld.decompose(Ei,e,zl),e}getWorldScale(e){return this.updateWorldMatrix(!0,!1),this.matrixWorld.decompose(Ei,Hl,e),e}getWorldDirection(e){this.updateWorldMatrix(!0,!1);const t=this.matrixWorld.elements;return e.set(t[8],t[9],t[10]).normalize()}raycast(){}intersectsFrustum(){return!0}traverse(e){e(this);const t=this.children;for(let n=0,i=t.length;n<i;n++)t[n].traverse(e)}traverseVisible(e){if(this.visible===!1)return;e(this);const t=this.children;for(let n=0,i=t.length;n<i;n++)t[n].traverseVisible(e)}traverseAncestors(e){const t=this.parent;t!==null&&(e(t),t.traverseAncestors(e))}updateMatrix(){this.matrix.compose(this.position,this.quaternion,this.scale);const e=this.pivot;if(e!==null){const t=e.x,n=e.y,i=e.z,r=this.matrix.elements;r[12]+=t-r[0]*t-r[4]*n-r[8]*i,r[13]+=n-r[1]*t-r[5]*n-r[9]*i,r[14]+=i-r[2]*t-r[6]*n-r[10]*i}this.matrixWorldNeedsUpdate=!0}updateMatrixWorld(e){this.matrixAutoUpdate&&this.updateMatrix(),(this.matrixWorldNeedsUpdate||e)&&(this.matrixWorldAutoUpdate===!0&&(this.parent===null?this.matrixWorld.copy(this.matrix):this.matrixWorld.multiplyMatrices(this.parent.matrixWorld,this.matrix)),this.matrixWorldNeedsUpdate=!1,e=!0);const t=this.children;for(let n=0,i=t.length;n<i;n++)t[n].updateMatrixWorld(e)}updateWorldMatrix(e,t,n=!1){const i=this.parent;if(e===!0&&i!==null&&i.updateWorldMatrix(!0,!1),this.matrixAutoUpdate&&this.updateMatrix(),(this.matrixWorldNeedsUpdate||n)&&(this.matrixWorldAutoUpdate===!0&&(this.parent===null?this.matrixWorld.copy(this.matrix):this.matrixWorld.multiplyMatrices(this.parent.matrixWorld,this.matrix)),this.matrixWorldNeedsUpdate=!1,n=!0),t===!0){const r=this.children;for(let a=0,o=r.length;a<o;a++)r[a].updateWorldMatrix(!1,!0,n)}}toJSON(e){const t=e===void 0||typeof e=="string",n={};t&&(e={geometries:{},materials:{},textures:{},images:{},shapes:{},skeletons:{},animations:{},nodes:{}},n.metadata={version:4.7,type:"Object",generator:"Object3D.toJSON"});const i={};i.uuid=this.uuid,i.type=this.type,i.name=this.name,i.castShadow=this.castShadow,i.receiveShadow=this.receiveShadow,i.visible=this.visible,i.frustumCulled=this.frustumCulled,i.renderOrder=this.renderOrder,i.static=this.static,i.matrixAutoUpdate=this.matrixAutoUpdate,Object.keys(this.userData).length>0&&(i.userData=this.userData),i.layers=this.layers.mask,i.matrix=this.matrix.toArray(),i.up=this.up.toArray(),this.pivot!==null&&(i.pivot=this.pivot.toArray()),this.morphTargetDictionary!==void 0&&(i.morphTargetDictionary=Object.assign({},this.morphTargetDictionary)),this.morphTargetInfluences!==void 0&&(i.morphTargetInfluences=this.morphTargetInfluences.slice()),this.isInstancedMesh&&(i.type="InstancedMesh",i.count=this.count,i.instanceMatrix=this.instanceMatrix.toJSON(),this.instanceColor!==null&&(i.instanceColor=this.instanceColor.toJSON())),this.isBatchedMesh&&(i.type="BatchedMesh",i.perObjectFrustumCulled=this.perObjectFrustumCulled,i.sortObjects=this.sortObjects,i.drawRanges=this._drawRanges,i.reservedRanges=this._reservedRanges,i.geometryInfo=this._geometryInfo.map(o=>({...o,boundingBox:o.boundingBox?o.boundingBox.toJSON():void 0,boundingSphere:o.boundingSphere?o.boundingSphere.toJSON():void 0})),i.instanceInfo=this._instanceInfo.map(o=>({...o})),i.availableInstanceIds=this._availableInstanceIds.slice(),i.availableGeometryIds=this._availableGeometryIds.slice(),i.nextIndexStart=this._nextIndexStart,i.nextVertexStart=this._nextVertexStart,i.geometryCount=this._geometryCount,i.maxInstanceCount=this._maxInstanceCount,i.maxVertexCount=this._maxVertexCount,i.maxIndexCount=this._maxIndexCount,i.geometryInitialized=this._geometryInitialized,i.matricesTexture=this._matricesTexture.toJSON(e),i.indirectTexture=this._indirectTexture.toJSON(e),this._colorsTexture!==null&&(i.colorsTexture=this._colorsTexture.toJSON(e)),this.boundingSphere!==null&&(i.boundingSphere=this.boundingSphere.toJSON()),this.boundingBox!==null&&(i.boundingBox=this.boundingBox.toJSON()));function r(o,l){return o[l.uuid]===void 0&&(o[l.uuid]=l.toJSON(e)),l.uuid}if(this.isScene)this.background&&(this.background.isColor?i.background=this.background.toJSON():this.background.isTexture&&(i.background=this.background.toJSON(e).uuid)),this.environment&&this.environment.isTexture&&this.environment.isRenderTargetTexture!==!0&&(i.environment=this.environment.toJSON(e).uuid);else if(this.isMesh||this.isLine||this.isPoints){i.geometry=r(e.geometries,this.geometry);const o=this.geometry.parameters;if(o!==void 0&&o.shapes!==void 0){const l=o.shapes;if(Array.isArray(l))for(let c=0,h=l.length;c<h;c++){const u=l[c];r(e.shapes,u)}else r(e.shapes,l)}}if(this.isSkinnedMesh&&(i.bindMode=this.bindMode,i.bindMatrix=this.bindMatrix.toArray(),this.skeleton!==void 0&&(r(e.skeletons,this.skeleton),i.skeleton=this.skeleton.uuid)),this.material!==void 0)if(Array.isArray(this.material)){const o=[];for(let l=0,c=this.material.length;l<c;l++)o.push(r(e.materials,this.material[l]));i.material=o}else i.material=r(e.materials,this.material);if(this.children.length>0){i.children=[];for(let o=0;o<this.children.length;o++)i.children.push(this.children[o].toJSON(e).object)}if(this.animations.length>0){i.animations=[];for(let o=0;o<this.animations.length;o++){const l=this.animations[o];i.animations.push(r(e.animations,l))}}if(t){const o=a(e.geometries),l=a(e.materials),c=a(e.textures),h=a(e.images),u=a(e.shapes),d=a(e.skeletons),f=a(e.animations),g=a(e.nodes);o.length>0&&(n.geometries=o),l.length>0&&(n.materials=l),c.length>0&&(n.textures=c),h.length>0&&(n.images=h),u.length>0&&(n.shapes=u),d.length>0&&(n.skeletons=d),f.length>0&&(n.animations=f),g.length>0&&(n.nodes=g)}return n.object=i,n;function a(o){const l=[];for(const c in o){const h=o[c];delete h.metadata,l.push(h)}return l}}clone(e){return new this.constructor().copy(this,e)}copy(e,t=!0){if(this.name=e.name,this.up.copy(e.up),this.position.copy(e.position),this.rotation.order=e.rotation.order,this.quaternion.copy(e.quaternion),this.scale.copy(e.scale),this.pivot=e.pivot!==null?e.pivot.clone():null,this.matrix.copy(e.matrix),this.matrixWorld.copy(e.matrixWorld),this.matrixAutoUpdate=e.matrixAutoUpdate,this.matrixWorldAutoUpdate=e.matrixWorldAutoUpdate,this.matrixWorldNeedsUpdate=e.matrixWorldNeedsUpdate,this.layers.mask=e.layers.mask,this.visible=e.visible,this.castShadow=e.castShadow,this.receiveShadow=e.receiveShadow,this.frustumCulled=e.frustumCulled,this.renderOrder=e.renderOrder,this.static=e.static,this.animations=e.animations.slice(),this.userData=JSON.parse(JSON.stringify(e.userData)),t===!0)for(let n=0;n<e.children.length;n++){const i=e.children[n];this.add(i.clone())}return this}dispose(){this.dispatchEvent({type:"dispose"})}}It.DEFAULT_UP=new D(0,1,0);It.DEFAULT_MATRIX_AUTO_UPDATE=!0;It.DEFAULT_MATRIX_WORLD_AUTO_UPDATE=!0;class Ot extends It{constructor(){super(),this.isGroup=!0,this.type="Group"}}const Wl={type:"move"};class rr{constructor(){this._targetRay=null,this._grip=null,this._hand=null}getHandSpace(){return this._hand===null&&(this._hand=new Ot,this._hand.matrixAutoUpdate=!1,this._hand.visible=!1,this._hand.joints={},this._hand.inputState={pinching:!1}),this._hand}getTargetRaySpace(){return this._targetRay===null&&(this._targetRay=new Ot,this._targetRay.matrixAutoUpdate=!1,this._targetRay.visible=!1,this._targetRay.hasLinearVelocity=!1,this._targetRay.linearVelocity=new D,this._targetRay.hasAngularVelocity=!1,this._targetRay.angularVelocity=new D),this._targetRay}getGripSpace(){return this._grip===null&&(this._grip=new Ot,this._grip.matrixAutoUpdate=!1,this._grip.visible=!1,this._grip.hasLinearVelocity=!1,this._grip.linearVelocity=new D,this._grip.hasAngularVelocity=!1,this._grip.angularVelocity=new D,this._grip.eventsEnabled=!1),this._grip}dispatchEvent(e){return this._targetRay!==null&&this._targetRay.dispatchEvent(e),this._grip!==null&&this._grip.dispatchEvent(e),this._hand!==null&&this._hand.dispatchEvent(e),this}connect(e){if(e&&e.hand){const t=this._hand;if(t)for(const n of e.hand.values())this._getHandJoint(t,n)}return this.dispatchEvent({type:"connected",data:e}),this}disconnect(e){return this.dispatchEvent({type:"disconnected",data:e}),this._targetRay!==null&&(this._targetRay.visible=!1),this._grip!==null&&(this._grip.visible=!1),this._hand!==null&&(this._hand.visible=!1),this}update(e,t,n){let i=null,r=null,a=null;const o=this._targetRay,l=this._grip,c=this._hand;if(e&&t.session.visibilityState!=="visible-blurred"){if(c&&e.hand){a=!0;for(const S of e.hand.values()){const m=t.getJointPose(S,n),p=this._getHandJoint(c,S);m!==null&&(p.matrix.fromArray(m.transform.matrix),p.matrix.decompose(p.position,p.quaternion,p.scale),p.matrixWorldNeedsUpdate=!0,p.jointRadius=m.radius),p.visible=m!==null}const h=c.joints["index-finger-tip"],u=c.joints["thumb-tip"],d=h.position.distanceTo(u.position),f=.02,g=.005;c.inputState.pinching&&d>f+g?(c.inputState.pinching=!1,this.dispatchEvent({type:"pinchend",handedness:e.handedness,target:this})):!c.inputState.pinching&&d<=f-g&&(c.inputState.pinching=!0,this.dispatchEvent({type:"pinchstart",handedness:e.handedness,target:this}))}else l!==null&&e.gripSpace&&(r=t.getPose(e.gripSpace,n),r!==null&&(l.matrix.fromArray(r.transform.matrix),l.matrix.decompose(l.position,l.quaternion,l.scale),l.matrixWorldNeedsUpdate=!0,r.linearVelocity?(l.hasLinearVelocity=!0,l.linearVelocity.copy(r.linearVelocity)):l.hasLinearVelocity=!1,r.angularVelocity?(l.hasAngularVelocity=!0,l.angularVelocity.copy(r.angularVelocity)):l.hasAngularVelocity=!1,l.eventsEnabled&&l.dispatchEvent({type:"gripUpdated",data:e,target:this})));o!==null&&(i=t.getPose(e.targetRaySpace,n),i===null&&r!==null&&(i=r),i!==null&&(o.matrix.fromArray(i.transform.matrix),o.matrix.decompose(o.position,o.quaternion,o.scale),o.matrixWorldNeedsUpdate=!0,i.linearVelocity?(o.hasLinearVelocity=!0,o.linearVelocity.copy(i.linearVelocity)):o.hasLinearVelocity=!1,i.angularVelocity?(o.hasAngularVelocity=!0,o.angularVelocity.copy(i.angularVelocity)):o.hasAngularVelocity=!1,this.dispatchEvent(Wl)))}return o!==null&&(o.visible=i!==null),l!==null&&(l.visible=r!==null),c!==null&&(c.visible=a!==null),this}_getHandJoint(e,t){if(e.joints[t.jointName]===void 0){const n=new Ot;n.matrixAutoUpdate=!1,n.visible=!1,e.joints[t.jointName]=n,e.add(n)}return e.joints[t.jointName]}}const Po={aliceblue:15792383,antiquewhite:16444375,aqua:65535,aquamarine:8388564,azure:15794175,beige:16119260,bisque:16770244,black:0,blanchedalmond:16772045,blue:255,blueviolet:9055202,brown:10824234,burlywood:14596231,cadetblue:6266528,chartreuse:8388352,chocolate:13789470,coral:16744272,cornflowerblue:6591981,cornsilk:16775388,crimson:14423100,cyan:65535,darkblue:139,darkcyan:35723,darkgoldenrod:12092939,darkgray:11119017,darkgreen:25600,darkgrey:11119017,darkkhaki:12433259,darkmagenta:9109643,darkolivegreen:5597999,darkorange:16747520,darkorchid:10040012,darkred:9109504,darksalmon:15308410,darkseagreen:9419919,darkslateblue:4734347,darkslategray:3100495,darkslategrey:3100495,darkturquoise:52945,darkviolet:9699539,deeppink:16716947,deepskyblue:49151,dimgray:6908265,dimgrey:6908265,dodgerblue:2003199,firebrick:11674146,floralwhite:16775920,forestgreen:2263842,fuchsia:16711935,gainsboro:14474460,ghostwhite:16316671,gold:16766720,goldenrod:14329120,gray:8421504,green:32768,greenyellow:11403055,grey:8421504,honeydew:15794160,hotpink:16738740,indianred:13458524,indigo:4915330,ivory:16777200,khaki:15787660,lavender:15132410,lavenderblush:16773365,lawngreen:8190976,lemonchiffon:16775885,lightblue:11393254,lightcoral:15761536,lightcyan:14745599,lightgoldenrodyellow:16448210,lightgray:13882323,lightgreen:9498256,lightgrey:13882323,lightpink:16758465,lightsalmon:16752762,lightseagreen:2142890,lightskyblue:8900346,lightslategray:7833753,lightslategrey:7833753,lightsteelblue:11584734,lightyellow:16777184,lime:65280,limegreen:3329330,linen:16445670,magenta:16711935,maroon:8388608,mediumaquamarine:6737322,mediumblue:205,mediumorchid:12211667,mediumpurple:9662683,mediumseagreen:3978097,mediumslateblue:8087790,mediumspringgreen:64154,mediumturquoise:4772300,mediumvioletred:13047173,midnightblue:1644912,mintcream:16121850,mistyrose:16770273,moccasin:16770229,navajowhite:16768685,navy:128,oldlace:16643558,olive:8421376,olivedrab:7048739,orange:16753920,orangered:16729344,orchid:14315734,palegoldenrod:15657130,palegreen:10025880,paleturquoise:11529966,palevioletred:14381203,papayawhip:16773077,peachpuff:16767673,peru:13468991,pink:16761035,plum:14524637,powderblue:11591910,purple:8388736,rebeccapurple:6697881,red:16711680,rosybrown:12357519,royalblue:4286945,saddlebrown:9127187,salmon:16416882,sandybrown:16032864,seagreen:3050327,seashell:16774638,sienna:10506797,silver:12632256,skyblue:8900331,slateblue:6970061,slategray:7372944,slategrey:7372944,snow:16775930,springgreen:65407,steelblue:4620980,tan:13808780,teal:32896,thistle:14204888,tomato:16737095,turquoise:4251856,violet:15631086,wheat:16113331,white:16777215,whitesmoke:16119285,yellow:16776960,yellowgreen:10145074},Pn={h:0,s:0,l:0},Yi={h:0,s:0,l:0};function ar(s,e,t){return t<0&&(t+=1),t>1&&(t-=1),t<1/6?s+(e-s)*6*t:t<1/2?e:t<2/3?s+(e-s)*6*(2/3-t):s}class Xe{constructor(e,t,n){return this.isColor=!0,this.r=1,this.g=1,this.b=1,this.set(e,t,n)}set(e,t,n){if(t===void 0&&n===void 0){const i=e;i&&i.isColor?this.copy(i):typeof i=="number"?this.setHex(i):typeof i=="string"&&this.setStyle(i)}else this.setRGB(e,t,n);return this}setScalar(e){return this.r=e,this.g=e,this.b=e,this}setHex(e,t=qt){return e=Math.floor(e),this.r=(e>>16&255)/255,this.g=(e>>8&255)/255,this.b=(e&255)/255,qe.colorSpaceToWorking(this,t),this}setRGB(e,t,n,i=qe.workingColorSpace){return this.r=e,this.g=t,this.b=n,qe.colorSpaceToWorking(this,i),this}setHSL(e,t,n,i=qe.workingColorSpace){if(e=Rl(e,1),t=ze(t,0,1),n=ze(n,0,1),t===0)this.r=this.g=this.b=n;else{const r=n<=.5?n*(1+t):n+t-n*t,a=2*n-r;this.r=ar(a,r,e+1/3),this.g=ar(a,r,e),this.b=ar(a,r,e-1/3)}return qe.colorSpaceToWorking(this,i),this}setStyle(e,t=qt){function n(r){r!==void 0&&parseFloat(r)<1&&Le("Color: Alpha component of "+e+" will be ignored.")}let i;if(i=/^(\w+)\(([^\)]*)\)/.exec(e)){let r;const a=i[1],o=i[2];switch(a){case"rgb":case"rgba":if(r=/^\s*(\d+)\s*,\s*(\d+)\s*,\s*(\d+)\s*(?:,\s*(\d+(?:\.\d+)?|\.\d+)\s*)?$/.exec(o))return n(r[4]),this.setRGB(Math.min(255,parseInt(r[1],10))/255,Math.min(255,parseInt(r[2],10))/255,Math.min(255,parseInt(r[3],10))/255,t);if(r=/^\s*(\d+(?:\.\d+)?|\.\d+)\%\s*,\s*(\d+(?:\.\d+)?|\.\d+)\%\s*,\s*(\d+(?:\.\d+)?|\.\d+)\%\s*(?:,\s*(\d+(?:\.\d+)?|\.\d+)\s*)?$/.exec(o))return n(r[4]),this.setRGB(Math.min(100,parseFloat(r[1]))/100,Math.min(100,parseFloat(r[2]))/100,Math.min(100,parseFloat(r[3]))/100,t);break;case"hsl":case"hsla":if(r=/^\s*([+-]?(?:\d+(?:\.\d+)?|\.\d+))\s*,\s*(\d+(?:\.\d+)?|\.\d+)\%\s*,\s*(\d+(?:\.\d+)?|\.\d+)\%\s*(?:,\s*(\d+(?:\.\d+)?|\.\d+)\s*)?$/.exec(o))return n(r[4]),this.setHSL(parseFloat(r[1])/360,parseFloat(r[2])/100,parseFloat(r[3])/100,t);break;default:Le("Color: Unknown color model "+e)}}else if(i=/^\#([A-Fa-f\d]+)$/.exec(e)){const r=i[1],a=r.length;if(a===3)return this.setRGB(parseInt(r.charAt(0),16)/15,parseInt(r.charAt(1),16)/15,parseInt(r.charAt(2),16)/15,t);if(a===6)return this.setHex(parseInt(r,16),t);Le("Color: Invalid hex color "+e)}else if(e&&e.length>0)return this.setColorName(e,t);return this}setColorName(e,t=qt){const n=Po[e.toLowerCase()];return n!==void 0?this.setHex(n,t):Le("Color: Unknown color "+e),this}clone(){return new this.constructor(this.r,this.g,this.b)}copy(e){return this.r=e.r,this.g=e.g,this.b=e.b,this}copySRGBToLinear(e){return this.r=yn(e.r),this.g=yn(e.g),this.b=yn(e.b),this}copyLinearToSRGB(e){return this.r=fi(e.r),this.g=fi(e.g),this.b=fi(e.b),this}convertSRGBToLinear(){return this.copySRGBToLinear(this),this}convertLinearToSRGB(){return this.copyLinearToSRGB(this),this}getHex(e=qt){return qe.workingToColorSpace(Lt.copy(this),e),Math.round(ze(Lt.r*255,0,255))*65536+Math.round(ze(Lt.g*255,0,255))*256+Math.round(ze(Lt.b*255,0,255))}getHexString(e=qt){return("000000"+this.getHex(e).toString(16)).slice(-6)}getHSL(e,t=qe.workingColorSpace){qe.workingToColorSpace(Lt.copy(this),t);const n=Lt.r,i=Lt.g,r=Lt.b,a=Math.max(n,i,r),o=Math.min(n,i,r);let l,c;const h=(o+a)/2;if(o===a)l=0,c=0;else{const u=a-o;switch(c=h<=.5?u/(a+o):u/(2-a-o),a){case n:l=(i-r)/u+(i<r?6:0);break;case i:l=(r-n)/u+2;break;case r:l=(n-i)/u+4;break}l/=6}return e.h=l,e.s=c,e.l=h,e}getRGB(e,t=qe.workingColorSpace){return qe.workingToColorSpace(Lt.copy(this),t),e.r=Lt.r,e.g=Lt.g,e.b=Lt.b,e}getStyle(e=qt){qe.workingToColorSpace(Lt.copy(this),e);const t=Lt.r,n=Lt.g,i=Lt.b;return e!==qt?`color(${e} ${t.toFixed(3)} ${n.toFixed(3)} ${i.toFixed(3)})`:`rgb(${Math.round(t*255)},${Math.round(n*255)},${Math.round(i*255)})`}offsetHSL(e,t,n){return this.getHSL(Pn),this.setHSL(Pn.h+e,Pn.s+t,Pn.l+n)}add(e){return this.r+=e.r,this.g+=e.g,this.b+=e.b,this}addColors(e,t){return this.r=e.r+t.r,this.g=e.g+t.g,this.b=e.b+t.b,this}addScalar(e){return this.r+=e,this.g+=e,this.b+=e,this}sub(e){return this.r=Math.max(0,this.r-e.r),this.g=Math.max(0,this.g-e.g),this.b=Math.max(0,this.b-e.b),this}multiply(e){return this.r*=e.r,this.g*=e.g,this.b*=e.b,this}multiplyScalar(e){return this.r*=e,this.g*=e,this.b*=e,this}lerp(e,t){return this.r+=(e.r-this.r)*t,this.g+=(e.g-this.g)*t,this.b+=(e.b-this.b)*t,this}lerpColors(e,t,n){return this.r=e.r+(t.r-e.r)*n,this.g=e.g+(t.g-e.g)*n,this.b=e.b+(t.b-e.b)*n,this}lerpHSL(e,t){this.getHSL(Pn),e.getHSL(Yi);const n=js(Pn.h,Yi.h,t),i=js(Pn.s,Yi.s,t),r=js(Pn.l,Yi.l,t);return this.setHSL(n,i,r),this}setFromVector3(e){return this.r=e.x,this.g=e.y,this.b=e.z,this}applyMatrix3(e){const t=this.r,n=this.g,i=this.b,r=e.elements;return this.r=r[0]*t+r[3]*n+r[6]*i,this.g=r[1]*t+r[4]*n+r[7]*i,this.b=r[2]*t+r[5]*n+r[8]*i,this}equals(e){return e.r===this.r&&e.g===this.g&&e.b===this.b}fromArray(e,t=0){return this.r=e[t],this.g=e[t+1],this.b=e[t+2],this}toArray(e=[],t=0){return e[t]=this.r,e[t+1]=this.g,e[t+2]=this.b,e}fromBufferAttribute(e,t){return this.r=e.getX(t),this.g=e.getY(t),this.b=e.getZ(t),this}toJSON(){return this.getHex()}*[Symbol.iterator](){yield this.r,yield this.g,yield this.b}}const Lt=new Xe;Xe.NAMES=Po;class Xl extends It{constructor(){super(),this.isScene=!0,this.type="Scene",this.background=null,this.environment=null,this.fog=null,this.backgroundBlurriness=0,this.backgroundIntensity=1,this.backgroundRotation=new Yn,this.environmentIntensity=1,this.environmentRotation=new Yn,this.overrideMaterial=null,typeof __THREE_DEVTOOLS__<"u"&&__THREE_DEVTOOLS__.dispatchEvent(new CustomEvent("observe",{detail:this}))}copy(e,t){return super.copy(e,t),this.background=e.background!==null?e.background.clone():null,this.environment=e.environment!==null?e.environment.clone():null,this.fog=e.fog!==null?e.fog.clone():null,this.backgroundBlurriness=e.backgroundBlurriness,this.backgroundIntensity=e.backgroundIntensity,this.backgroundRotation.copy(e.backgroundRotation),this.environmentIntensity=e.environmentIntensity,this.environmentRotation.copy(e.environmentRotation),this.overrideMaterial=e.overrideMaterial!==null?e.overrideMaterial.clone():null,this.matrixAutoUpdate=e.matrixAutoUpdate,this}toJSON(e){const t=super.toJSON(e);return this.fog!==null&&(t.object.fog=this.fog.toJSON()),t.object.backgroundBlurriness=this.backgroundBlurriness,t.object.backgroundIntensity=this.backgroundIntensity,t.object.backgroundRotation=this.backgroundRotation.toArray(),t.object.environmentIntensity=this.environmentIntensity,t.object.environmentRotation=this.environmentRotation.toArray(),t}}const en=new D,vn=new D,or=new D,xn=new D,ii=new D,si=new D,wa=new D,lr=new D,cr=new D,hr=new D,dr=new gt,ur=new gt,fr=new gt;class rn{constructor(e=new D,t=new D,n=new D){this.a=e,this.b=t,this.c=n}static getNormal(e,t,n,i){i.subVectors(n,t),en.subVectors(e,t),i.cross(en);const r=i.lengthSq();return r>0?i.multiplyScalar(1/Math.sqrt(r)):i.set(0,0,0)}static getBarycoord(e,t,n,i,r){en.subVectors(i,t),vn.subVectors(n,t),or.subVectors(e,t);const a=en.dot(en),o=en.dot(vn),l=en.dot(or),c=vn.dot(vn),h=vn.dot(or),u=a*c-o*o;if(u===0)return r.set(0,0,0),null;const d=1/u,f=(c*l-o*h)*d,g=(a*h-o*l)*d;return r.set(1-f-g,g,f)}static containsPoint(e,t,n,i){return this.getBarycoord(e,t,n,i,xn)===null?!1:xn.x>=0&&xn.y>=0&&xn.x+xn.y<=1}static getInterpolation(e,t,n,i,r,a,o,l){return this.getBarycoord(e,t,n,i,xn)===null?(l.x=0,l.y=0,"z"in l&&(l.z=0),"w"in l&&(l.w=0),null):(l.setScalar(0),l.addScaledVector(r,xn.x),l.addScaledVector(a,xn.y),l.addScaledVector(o,xn.z),l)}static getInterpolatedAttribute(e,t,n,i,r,a){return dr.setScalar(0),ur.setScalar(0),fr.setScalar(0),dr.fromBufferAttribute(e,t),ur.fromBufferAttribute(e,n),fr.fromBufferAttribute(e,i),a.setScalar(0),a.addScaledVector(dr,r.x),a.addScaledVector(ur,r.y),a.addScaledVector(fr,r.z),a}static isFrontFacing(e,t,n,i){return en.subVectors(n,t),vn.subVectors(e,t),en.cross(vn).dot(i)<0}set(e,t,n){return this.a.copy(e),this.b.copy(t),this.c.copy(n),this}setFromPointsAndIndices(e,t,n,i){return this.a.copy(e[t]),this.b.copy(e[n]),this.c.copy(e[i]),this}setFromAttributeAndIndices(e,t,n,i){return this.a.fromBufferAttribute(e,t),this.b.fromBufferAttribute(e,n),this.c.fromBufferAttribute(e,i),this}clone(){return new this.constructor().copy(this)}copy(e){return this.a.copy(e.a),this.b.copy(e.b),this.c.copy(e.c),this}getArea(){return en.subVectors(this.c,this.b),vn.subVectors(this.a,this.b),en.cross(vn).length()*.5}getMidpoint(e){return e.addVectors(this.a,this.b).add(this.c).multiplyScalar(1/3)}getNormal(e){return rn.getNormal(this.a,this.b,this.c,e)}getPlane(e){return e.setFromCoplanarPoints(this.a,this.b,this.c)}getBarycoord(e,t){return rn.getBarycoord(e,this.a,this.b,this.c,t)}getInterpolation(e,t,n,i,r){return rn.getInterpolation(e,this.a,this.b,this.c,t,n,i,r)}containsPoint(e){return rn.containsPoint(e,this.a,this.b,this.c)}isFrontFacing(e){return rn.isFrontFacing(this.a,this.b,this.c,e)}intersectsBox(e){return e.intersectsTriangle(this)}closestPointToPoint(e,t){const n=this.a,i=this.b,r=this.c;let a,o;ii.subVectors(i,n),si.subVectors(r,n),lr.subVectors(e,n);const l=ii.dot(lr),c=si.dot(lr);if(l<=0&&c<=0)return t.copy(n);cr.subVectors(e,i);const h=ii.dot(cr),u=si.dot(cr);if(h>=0&&u<=h)return t.copy(i);const d=l*u-h*c;if(d<=0&&l>=0&&h<=0&&l-h>0)return a=l/(l-h),t.copy(n).addScaledVector(ii,a);hr.subVectors(e,r);const f=ii.dot(hr),g=si.dot(hr);if(g>=0&&f<=g)return t.copy(r);const S=f*c-l*g;if(S<=0&&c>=0&&g<=0)return o=c/(c-g),t.copy(n).addScaledVector(si,o);const m=h*g-f*u;if(m<=0&&u-h>=0&&f-g>=0)return wa.subVectors(r,i),o=(u-h)/(u-h+(f-g)),t.copy(i).addScaledVector(wa,o);const p=1/(m+S+d);return a=S*p,o=d*p,t.copy(n).addScaledVector(ii,a).addScaledVector(si,o)}equals(e){return e.a.equals(this.a)&&e.b.equals(this.b)&&e.c.equals(this.c)}}class vt{constructor(e=new D(1/0,1/0,1/0),t=new D(-1/0,-1/0,-1/0)){this.isBox3=!0,this.min=e,this.max=t}set(e,t){return this.min.copy(e),this.max.copy(t),this}setFromArray(e){this.makeEmpty();for(let t=0,n=e.length;t<n;t+=3)this.expandByPoint(tn.fromArray(e,t));return this}setFromBufferAttribute(e){this.makeEmpty();for(let t=0,n=e.count;t<n;t++)this.expandByPoint(tn.fromBufferAttribute(e,t));return this}setFromPoints(e){this.makeEmpty();for(let t=0,n=e.length;t<n;t++)this.expandByPoint(e[t]);return this}setFromCenterAndSize(e,t){const n=tn.copy(t).multiplyScalar(.5);return this.min.copy(e).sub(n),this.max.copy(e).add(n),this}setFromObject(e,t=!1){return this.makeEmpty(),this.expandByObject(e,t)}clone(){return new this.constructor().copy(this)}copy(e){return this.min.copy(e.min),this.max.copy(e.max),this}makeEmpty(){return this.min.x=this.min.y=this.min.z=1/0,this.max.x=this.max.y=this.max.z=-1/0,this}isEmpty(){return this.max.x<this.min.x||this.max.y<this.min.y||this.max.z<this.min.z}getCenter(e){return this.isEmpty()?e.set(0,0,0):e.addVectors(this.min,this.max).multiplyScalar(.5)}getSize(e){return this.isEmpty()?e.set(0,0,0):e.subVectors(this.max,this.min)}expandByPoint(e){return this.min.min(e),this.max.max(e),this}expandByVector(e){return this.min.sub(e),this.max.add(e),this}expandByScalar(e){return this.min.addScalar(-e),this.max.addScalar(e),this}expandByObject(e,t=!1){e.updateWorldMatrix(!1,!1);const n=e.geometry;if(n!==void 0){const r=n.getAttribute("position");if(t===!0&&r!==void 0&&e.isInstancedMesh!==!0&&e.isBatchedMesh!==!0)for(let a=0,o=r.count;a<o;a++)e.isMesh===!0?e.getVertexPosition(a,tn):tn.fromBufferAttribute(r,a),tn.applyMatrix4(e.matrixWorld),this.expandByPoint(tn);else e.boundingBox!==void 0?(e.boundingBox===null&&e.computeBoundingBox(),Ki.copy(e.boundingBox)):(n.boundingBox===null&&n.computeBoundingBox(),Ki.copy(n.boundingBox)),Ki.applyMatrix4(e.matrixWorld),this.union(Ki)}const i=e.children;for(let r=0,a=i.length;r<a;r++)this.expandByObject(i[r],t);return this}containsPoint(e){return e.x>=this.min.x&&e.x<=this.max.x&&e.y>=this.min.y&&e.y<=this.max.y&&e.z>=this.min.z&&e.z<=this.max.z}containsBox(e){return this.min.x<=e.min.x&&e.max.x<=this.max.x&&this.min.y<=e.min.y&&e.max.y<=this.max.y&&this.min.z<=e.min.z&&e.max.z<=this.max.z}getParameter(e,t){return t.set((e.x-this.min.x)/(this.max.x-this.min.x),(e.y-this.min.y)/(this.max.y-this.min.y),(e.z-this.min.z)/(this.max.z-this.min.z))}intersectsBox(e){return e.max.x>=this.min.x&&e.min.x<=this.max.x&&e.max.y>=this.min.y&&e.min.y<=this.max.y&&e.max.z>=this.min.z&&e.min.z<=this.max.z}intersectsSphere(e){return this.clampPoint(e.center,tn),tn.distanceToSquared(e.center)<=e.radius*e.radius}intersectsPlane(e){let t,n;return e.normal.x>0?(t=e.normal.x*this.min.x,n=e.normal.x*this.max.x):(t=e.normal.x*this.max.x,n=e.normal.x*this.min.x),e.normal.y>0?(t+=e.normal.y*this.min.y,n+=e.normal.y*this.max.y):(t+=e.normal.y*this.max.y,n+=e.normal.y*this.min.y),e.normal.z>0?(t+=e.normal.z*this.min.z,n+=e.normal.z*this.max.z):(t+=e.normal.z*this.max.z,n+=e.normal.z*this.min.z),t<=-e.constant&&n>=-e.constant}intersectsTriangle(e){if(this.isEmpty())return!1;this.getCenter(Ti),Zi.subVectors(this.max,Ti),ri.subVectors(e.a,Ti),ai.subVectors(e.b,Ti),oi.subVectors(e.c,Ti),Ln.subVectors(ai,ri),Dn.subVectors(oi,ai),Gn.subVectors(ri,oi);let t=[0,-Ln.z,Ln.y,0,-Dn.z,Dn.y,0,-Gn.z,Gn.y,Ln.z,0,-Ln.x,Dn.z,0,-Dn.x,Gn.z,0,-Gn.x,-Ln.y,Ln.x,0,-Dn.y,Dn.x,0,-Gn.y,Gn.x,0];return!pr(t,ri,ai,oi,Zi)||(t=[1,0,0,0,1,0,0,0,1],!pr(t,ri,ai,oi,Zi))?!1:(Ji.crossVectors(Ln,Dn),t=[Ji.x,Ji.y,Ji.z],pr(t,ri,ai,oi,Zi))}clampPoint(e,t){return t.copy(e).clamp(this.min,this.max)}distanceToPoint(e){return this.clampPoint(e,tn).distanceTo(e)}getBoundingSphere(e){return this.isEmpty()?e.makeEmpty():(this.getCenter(e.center),e.radius=this.getSize(tn).length()*.5),e}intersect(e){return this.min.max(e.min),this.max.min(e.max),this.isEmpty()&&this.makeEmpty(),this}union(e){return this.min.min(e.min),this.max.max(e.max),this}applyMatrix4(e){return this.isEmpty()?this:(Sn[0].set(this.min.x,this.min.y,this.min.z).applyMatrix4(e),Sn[1].set(this.min.x,this.min.y,this.max.z).applyMatrix4(e),Sn[2].set(this.min.x,this.max.y,this.min.z).applyMatrix4(e),Sn[3].set(this.min.x,this.max.y,this.max.z).applyMatrix4(e),Sn[4].set(this.max.x,this.min.y,this.min.z).applyMatrix4(e),Sn[5].set(this.max.x,this.min.y,this.max.z).applyMatrix4(e),Sn[6].set(this.max.x,this.max.y,this.min.z).applyMatrix4(e),Sn[7].set(this.max.x,this.max.y,this.max.z).applyMatrix4(e),this.setFromPoints(Sn),this)}translate(e){return this.min.add(e),this.max.add(e),this}equals(e){return e.min.equals(this.min)&&e.max.equals(this.max)}toJSON(){return{min:this.min.toArray(),max:this.max.toArray()}}fromJSON(e){return this.min.fromArray(e.min),this.max.fromArray(e.max),this}}const Sn=[new D,new D,new D,new D,new D,new D,new D,new D],tn=new D,Ki=new vt,ri=new D,ai=new D,oi=new D,Ln=new D,Dn=new D,Gn=new D,Ti=new D,Zi=new D,Ji=new D,zn=new D;function pr(s,e,t,n,i){for(let r=0,a=s.length-3;r<=a;r+=3){zn.fromArray(s,r);const o=i.x*Math.abs(zn.x)+i.y*Math.abs(zn.y)+i.z*Math.abs(zn.z),l=e.dot(zn),c=t.dot(zn),h=n.dot(zn);if(Math.max(-Math.max(l,c,h),Math.min(l,c,h))>o)return!1}return!0}const mt=new D,Qi=new Ye;let $l=0;class ct extends Jn{constructor(e,t,n=!1){if(super(),Array.isArray(e))throw new TypeError("THREE.BufferAttribute: array should be a Typed Array.");this.isBufferAttribute=!0,Object.defineProperty(this,"id",{value:$l++}),this.name="",this.array=e,this.itemSize=t,this.count=e!==void 0?e.length/t:0,this.normalized=n,this.usage=35044,this.updateRanges=[],this.gpuType=1015,this.version=0,this._normalizationScale=e!==void 0?Gr(e):void 0}onUploadCallback(){}set needsUpdate(e){e===!0&&this.version++}setUsage(e){return this.usage=e,this}addUpdateRange(e,t){this.updateRanges.push({start:e,count:t})}clearUpdateRanges(){this.updateRanges.length=0}copy(e){return this.name=e.name,this.array=new e.array.constructor(e.array),this.itemSize=e.itemSize,this.count=e.count,this.normalized=e.normalized,this.usage=e.usage,this.gpuType=e.gpuType,this._normalizationScale=e._normalizationScale,this}copyAt(e,t,n){e*=this.itemSize,n*=t.itemSize;for(let i=0,r=this.itemSize;i<r;i++)this.array[e+i]=t.array[n+i];return this}copyArray(e){return this.array.set(e),this}applyMatrix3(e){if(this.itemSize===2)for(let t=0,n=this.count;t<n;t++)Qi.fromBufferAttribute(this,t),Qi.applyMatrix3(e),this.setXY(t,Qi.x,Qi.y);else if(this.itemSize===3)for(let t=0,n=this.count;t<n;t++)mt.fromBufferAttribute(this,t),mt.applyMatrix3(e),this.setXYZ(t,mt.x,mt.y,mt.z);return this}applyMatrix4(e){for(let t=0,n=this.count;t<n;t++)mt.fromBufferAttribute(this,t),mt.applyMatrix4(e),this.setXYZ(t,mt.x,mt.y,mt.z);return this}applyNormalMatrix(e){for(let t=0,n=this.count;t<n;t++)mt.fromBufferAttribute(this,t),mt.applyNormalMatrix(e),this.setXYZ(t,mt.x,mt.y,mt.z);return this}transformDirection(e){for(let t=0,n=this.count;t<n;t++)mt.fromBufferAttribute(this,t),mt.transformDirection(e),this.setXYZ(t,mt.x,mt.y,mt.z);return this}set(e,t=0){return this.array.set(e,t),this}getComponent(e,t){let n=this.array[e*this.itemSize+t];return this.normalized&&(n=this._denormalize(n)),n}setComponent(e,t,n){return this.normalized&&(n=this._normalize(n)),this.array[e*this.itemSize+t]=n,this}getX(e){let t=this.array[e*this.itemSize];return this.normalized&&(t=this._denormalize(t)),t}setX(e,t){return this.normalized&&(t=this._normalize(t)),this.array[e*this.itemSize]=t,this}getY(e){let t=this.array[e*this.itemSize+1];return this.normalized&&(t=this._denormalize(t)),t}setY(e,t){return this.normalized&&(t=this._normalize(t)),this.array[e*this.itemSize+1]=t,this}getZ(e){let t=this.array[e*this.itemSize+2];return this.normalized&&(t=this._denormalize(t)),t}setZ(e,t){return this.normalized&&(t=this._normalize(t)),this.array[e*this.itemSize+2]=t,this}getW(e){let t=this.array[e*this.itemSize+3];return this.normalized&&(t=this._denormalize(t)),t}setW(e,t){return this.normalized&&(t=this._normalize(t)),this.array[e*this.itemSize+3]=t,this}setXY(e,t,n){return e*=this.itemSize,this.normalized&&(t=this._normalize(t),n=this._normalize(n)),this.array[e+0]=t,this.array[e+1]=n,this}setXYZ(e,t,n,i){return e*=this.itemSize,this.normalized&&(t=this._normalize(t),n=this._normalize(n),i=this._normalize(i)),this.array[e+0]=t,this.array[e+1]=n,this.array[e+2]=i,this}setXYZW(e,t,n,i,r){return e*=this.itemSize,this.normalized&&(t=this._normalize(t),n=this._normalize(n),i=this._normalize(i),r=this._normalize(r)),this.array[e+0]=t,this.array[e+1]=n,this.array[e+2]=i,this.array[e+3]=r,this}onUpload(e){return this.onUploadCallback=e,this}clone(){return new this.constructor(this.array,this.itemSize).copy(this)}toJSON(){const e={itemSize:this.itemSize,type:this.array.constructor.name,array:Array.from(this.array),normalized:this.normalized};return e.name=this.name,e.usage=this.usage,e.gpuType=this.gpuType,e}dispose(){this.dispatchEvent({type:"dispose"})}_denormalize(e){const t=this._normalizationScale;return t!==void 0?Math.max(e/t,-1):Pl(e,this.array)}_normalize(e){const t=this._normalizationScale;return t!==void 0?Math.round(e*t):Ll(e,this.array)}}class Lo extends ct{constructor(e,t,n){super(new Uint16Array(e),t,n)}}class Do extends ct{constructor(e,t,n){super(new Uint32Array(e),t,n)}}class Jt extends ct{constructor(e,t,n){super(new Float32Array(e),t,n)}}const ql=new vt,Ai=new D,mr=new D;class Qn{constructor(e=new D,t=-1){this.isSphere=!0,this.center=e,this.radius=t}set(e,t){return this.center.copy(e),this.radius=t,this}setFromPoints(e,t){const n=this.center;t!==void 0?n.copy(t):ql.setFromPoints(e).getCenter(n);let i=0;for(let r=0,a=e.length;r<a;r++)i=Math.max(i,n.distanceToSquared(e[r]));return this.radius=Math.sqrt(i),this}copy(e){return this.center.copy(e.center),this.radius=e.radius,this}isEmpty(){return this.radius<0}makeEmpty(){return this.center.set(0,0,0),this.radius=-1,this}containsPoint(e){return e.distanceToSquared(this.center)<=this.radius*this.radius}distanceToPoint(e){return e.distanceTo(this.center)-this.radius}intersectsSphere(e){const t=this.radius+e.radius;return e.center.distanceToSquared(this.center)<=t*t}intersectsBox(e){return e.intersectsSphere(this)}intersectsPlane(e){return Math.abs(e.distanceToPoint(this.center))<=this.radius}clampPoint(e,t){const n=this.center.distanceToSquared(e);return t.copy(e),n>this.radius*this.radius&&(t.sub(this.center).normalize(),t.multiplyScalar(this.radius).add(this.center)),t}getBoundingBox(e){return this.isEmpty()?(e.makeEmpty(),e):(e.set(this.center,this.center),e.expandByScalar(this.radius),e)}applyMatrix4(e){return this.center.applyMatrix4(e),this.radius=this.radius*e.getMaxScaleOnAxis(),this}translate(e){return this.center.add(e),this}expandByPoint(e){if(this.isEmpty())return this.center.copy(e),this.radius=0,this;Ai.subVectors(e,this.center);const t=Ai.lengthSq();if(t>this.radius*this.radius){const n=Math.sqrt(t),i=(n-this.radius)*.5;this.center.addScaledVector(Ai,i/n),this.radius+=i}return this}union(e){return e.isEmpty()?this:this.isEmpty()?(this.copy(e),this):(this.center.equals(e.center)===!0?this.radius=Math.max(this.radius,e.radius):(mr.subVectors(e.center,this.center).setLength(e.radius),this.expandByPoint(Ai.copy(e.center).add(mr)),this.expandByPoint(Ai.copy(e.center).sub(mr))),this)}equals(e){return e.center.equals(this.center)&&e.radius===this.radius}clone(){return new this.constructor().copy(this)}toJSON(){return{radius:this.radius,center:this.center.toArray()}}fromJSON(e){return this.radius=e.radius,this.center.fromArray(e.center),this}}let Yl=0;const $t=new Qe,gr=new It,li=new D,Gt=new vt,Ri=new vt,bt=new D;class ht extends Jn{constructor(){super(),this.isBufferGeometry=!0,Object.defineProperty(this,"id",{value:Yl++}),this.uuid=zi(),this.name="",this.type="BufferGeometry",this.index=null,this.indirect=null,this.indirectOffset=0,this.attributes={},this.morphAttributes={},this.morphTargetsRelative=!1,this.groups=[],this.boundingBox=null,this.boundingSphere=null,this.drawRange={start:0,count:1/0},this.userData={},this._transformed=!1}getIndex(){return this.index}setIndex(e){return Array.isArray(e)?this.index=new(bl(e)?Do:Lo)(e,1):this.index=e,this}setIndirect(e,t=0){return this.indirect=e,this.indirectOffset=t,this}getIndirect(){return this.indirect}getAttribute(e){return this.attributes[e]}setAttribute(e,t){return this.attributes[e]=t,this}deleteAttribute(e){return delete this.attributes[e],this}hasAttribute(e){return this.attributes[e]!==void 0}addGroup(e,t,n=0){this.groups.push({start:e,count:t,materialIndex:n})}clearGroups(){this.groups=[]}setDrawRange(e,t){this.drawRange.start=e,this.drawRange.count=t}applyMatrix4(e){const t=this.attributes.position;t!==void 0&&(t.applyMatrix4(e),t.needsUpdate=!0);const n=this.attributes.normal;if(n!==void 0){const r=new Ue().getNormalMatrix(e);n.applyNormalMatrix(r),n.needsUpdate=!0}const i=this.attributes.tangent;return i!==void 0&&(i.transformDirection(e),i.needsUpdate=!0),this.boundingBox!==null&&this.computeBoundingBox(),this.boundingSphere!==null&&this.computeBoundingSphere(),this._transformed=!0,this}applyQuaternion(e){return $t.makeRotationFromQuaternion(e),this.applyMatrix4($t),this}rotateX(e){return $t.makeRotationX(e),this.applyMatrix4($t),this}rotateY(e){return $t.makeRotationY(e),this.applyMatrix4($t),this}rotateZ(e){return $t.makeRotationZ(e),this.applyMatrix4($t),this}translate(e,t,n){return $t.makeTranslation(e,t,n),this.applyMatrix4($t),this}scale(e,t,n){return $t.makeScale(e,t,n),this.applyMatrix4($t),this}lookAt(e){return gr.lookAt(e),gr.updateMatrix(),this.applyMatrix4(gr.matrix),this}center(){return this.computeBoundingBox(),this.boundingBox.getCenter(li).negate(),this.translate(li.x,li.y,li.z),this}setFromPoints(e){const t=this.getAttribute("position");if(t===void 0){const n=[];for(let i=0,r=e.length;i<r;i++){const a=e[i];n.push(a.x,a.y,a.z||0)}this.setAttribute("position",new Jt(n,3))}else{const n=Math.min(e.length,t.count);for(let i=0;i<n;i++){const r=e[i];t.setXYZ(i,r.x,r.y,r.z||0)}e.length>t.count&&Le("BufferGeometry: Buffer size too small for points data. Use .dispose() and create a new geometry."),t.needsUpdate=!0}return this}computeBoundingBox(){this.boundingBox===null&&(this.boundingBox=new vt);const e=this.attributes.position,t=this.morphAttributes.position;if(e&&e.isGLBufferAttribute){Je("BufferGeometry.computeBoundingBox(): GLBufferAttribute requires a manual bounding box.",this),this.boundingBox.set(new D(-1/0,-1/0,-1/0),new D(1/0,1/0,1/0));return}if(e!==void 0){if(this.boundingBox.setFromBufferAttribute(e),t)for(let n=0,i=t.length;n<i;n++){const r=t[n];Gt.setFromBufferAttribute(r),this.morphTargetsRelative?(bt.addVectors(this.boundingBox.min,Gt.min),this.boundingBox.expandByPoint(bt),bt.addVectors(this.boundingBox.max,Gt.max),this.boundingBox.expandByPoint(bt)):(this.boundingBox.expandByPoint(Gt.min),this.boundingBox.expandByPoint(Gt.max))}}else this.boundingBox.makeEmpty();(isNaN(this.boundingBox.min.x)||isNaN(this.boundingBox.min.y)||isNaN(this.boundingBox.min.z))&&Je('BufferGeometry.computeBoundingBox(): Computed min/max have NaN values. The "position" attribute is likely to have NaN values.',this)}computeBoundingSphere(){this.boundingSphere===null&&(this.boundingSphere=new Qn);const e=this.attributes.position,t=this.morphAttributes.position;if(e&&e.isGLBufferAttribute){Je("BufferGeometry.computeBoundingSphere(): GLBufferAttribute requires a manual bounding sphere.",this),this.boundingSphere.set(new D,1/0);return}if(e){const n=this.boundingSphere.center;if(Gt.setFromBufferAttribute(e),t)for(let r=0,a=t.length;r<a;r++){const o=t[r];Ri.setFromBufferAttribute(o),this.morphTargetsRelative?(bt.addVectors(Gt.min,Ri.min),Gt.expandByPoint(bt),bt.addVectors(Gt.max,Ri.max),Gt.expandByPoint(bt)):(Gt.expandByPoint(Ri.min),Gt.expandByPoint(Ri.max))}Gt.getCenter(n);let i=0;for(let r=0,a=e.count;r<a;r++)bt.fromBufferAttribute(e,r),i=Math.max(i,n.distanceToSquared(bt));if(t)for(let r=0,a=t.length;r<a;r++){const o=t[r],l=this.morphTargetsRelative;for(let c=0,h=o.count;c<h;c++)bt.fromBufferAttribute(o,c),l&&(li.fromBufferAttribute(e,c),bt.add(li)),i=Math.max(i,n.distanceToSquared(bt))}this.boundingSphere.radius=Math.sqrt(i),isNaN(this.boundingSphere.radius)&&Je('BufferGeometry.computeBoundingSphere(): Computed radius is NaN. The "position" attribute is likely to have NaN values.',this)}}computeTangents(){const e=this.index,t=this.attributes;if(e===null||t.position===void 0||t.normal===void 0||t.uv===void 0){Je("BufferGeometry: .computeTangents() failed. Missing required attributes (index, position, normal or uv)");return}const n=t.position,i=t.normal,r=t.uv;let a=this.getAttribute("tangent");(a===void 0||a.count!==n.count)&&(a=new ct(new Float32Array(4*n.count),4),this.setAttribute("tangent",a));const o=[],l=[],c=new Uint8Array(n.count);for(let k=0;k<n.count;k++)o[k]=new D,l[k]=new D;const h=new D,u=new D,d=new D,f=new Ye,g=new Ye,S=new Ye,m=new D,p=new D;function M(k,N,I){c[k]=c[N]=c[I]=1,h.fromBufferAttribute(n,k),u.fromBufferAttribute(n,N),d.fromBufferAttribute(n,I),f.fromBufferAttribute(r,k),g.fromBufferAttribute(r,N),S.fromBufferAttribute(r,I),u.sub(h),d.sub(h),g.sub(f),S.sub(f);const z=1/(g.x*S.y-S.x*g.y);isFinite(z)&&(m.copy(u).multiplyScalar(S.y).addScaledVector(d,-g.y).multiplyScalar(z),p.copy(d).multiplyScalar(g.x).addScaledVector(u,-S.x).multiplyScalar(z),o[k].add(m),o[N].add(m),o[I].add(m),l[k].add(p),l[N].add(p),l[I].add(p))}let A=this.groups;A.length===0&&(A=[{start:0,count:e.count}]);for(let k=0,N=A.length;k<N;++k){const I=A[k],z=I.start,$=I.count;for(let P=z,W=z+$;P<W;P+=3)M(e.getX(P+0),e.getX(P+1),e.getX(P+2))}const b=new D,R=new D,E=new D,_=new D;function y(k){E.fromBufferAttribute(i,k),_.copy(E);const N=o[k];b.copy(N),b.sub(E.multiplyScalar(E.dot(N))).normalize(),R.crossVectors(_,N);const z=R.dot(l[k])<0?-1:1;a.setXYZW(k,b.x,b.y,b.z,z)}for(let k=0,N=n.count;k<N;++k)c[k]&&y(k);this._transformed=!0}computeVertexNormals(){const e=this.index,t=this.getAttribute("position");if(t!==void 0){let n=this.getAttribute("normal");if(n===void 0||n.count!==t.count)n=new ct(new Float32Array(t.count*3),3),this.setAttribute("normal",n);else for(let d=0,f=n.count;d<f;d++)n.setXYZ(d,0,0,0);const i=new D,r=new D,a=new D,o=new D,l=new D,c=new D,h=new D,u=new D;if(e)for(let d=0,f=e.count;d<f;d+=3){const g=e.getX(d+0),S=e.getX(d+1),m=e.getX(d+2);i.fromBufferAttribute(t,g),r.fromBufferAttribute(t,S),a.fromBufferAttribute(t,m),h.subVectors(a,r),u.subVectors(i,r),h.cross(u),o.fromBufferAttribute(n,g),l.fromBufferAttribute(n,S),c.fromBufferAttribute(n,m),o.add(h),l.add(h),c.add(h),n.setXYZ(g,o.x,o.y,o.z),n.setXYZ(S,l.x,l.y,l.z),n.setXYZ(m,c.x,c.y,c.z)}else for(let d=0,f=t.count;d<f;d+=3)i.fromBufferAttribute(t,d+0),r.fromBufferAttribute(t,d+1),a.fromBufferAttribute(t,d+2),h.subVectors(a,r),u.subVectors(i,r),h.cross(u),n.setXYZ(d+0,h.x,h.y,h.z),n.setXYZ(d+1,h.x,h.y,h.z),n.setXYZ(d+2,h.x,h.y,h.z);this.normalizeNormals(),n.needsUpdate=!0}}normalizeNormals(){const e=this.attributes.normal;for(let t=0,n=e.count;t<n;t++)bt.fromBufferAttribute(e,t),bt.normalize(),e.setXYZ(t,bt.x,bt.y,bt.z)}toNonIndexed(){function e(o,l){const c=o.array,h=o.itemSize,u=o.normalized,d=new c.constructor(l.length*h);let f=0,g=0;for(let S=0,m=l.length;S<m;S++){o.isInterleavedBufferAttribute?f=l[S]*o.data.stride+o.offset:f=l[S]*h;for(let p=0;p<h;p++)d[g++]=c[f++]}return new ct(d,h,u)}if(this.index===null)return Le("BufferGeometry.toNonIndexed(): BufferGeometry is already non-indexed."),this;const t=new ht,n=this.index.array,i=this.attributes;for(const o in i){const l=i[o],c=e(l,n);t.setAttribute(o,c)}const r=this.morphAttributes;for(const o in r){const l=[],c=r[o];for(let h=0,u=c.length;h<u;h++){const d=c[h],f=e(d,n);l.push(f)}t.morphAttributes[o]=l}t.morphTargetsRelative=this.morphTargetsRelative;const a=this.groups;for(let o=0,l=a.length;o<l;o++){const c=a[o];t.addGroup(c.start,c.count,c.materialIndex)}return t}toJSON(){const e={metadata:{version:4.7,type:"BufferGeometry",generator:"BufferGeometry.toJSON"}};if(e.uuid=this.uuid,e.type=this.parameters!==void 0&&this._transformed===!0?"BufferGeometry":this.type,e.name=this.name,Object.keys(this.userData).length>0&&(e.userData=this.userData),this.parameters!==void 0&&this._transformed!==!0){const l=this.parameters;for(const c in l)l[c]!==void 0&&(e[c]=l[c]);return e}e.data={attributes:{}};const t=this.index;t!==null&&(e.data.index={type:t.array.constructor.name,array:Array.prototype.slice.call(t.array)});const n=this.attributes;for(const l in n){const c=n[l];e.data.attributes[l]=c.toJSON(e.data)}const i={};let r=!1;for(const l in this.morphAttributes){const c=this.morphAttributes[l],h=[];for(let u=0,d=c.length;u<d;u++){const f=c[u];h.push(f.toJSON(e.data))}h.length>0&&(i[l]=h,r=!0)}r&&(e.data.morphAttributes=i,e.data.morphTargetsRelative=this.morphTargetsRelative);const a=this.groups;a.length>0&&(e.data.groups=JSON.parse(JSON.stringify(a)));const o=this.boundingSphere;return o!==null&&(e.data.boundingSphere=o.toJSON()),e}clone(){return new this.constructor().copy(this)}copy(e){this.index=null,this.attributes={},this.morphAttributes={},this.groups=[],this.boundingBox=null,this.boundingSphere=null;const t={};this.name=e.name;const n=e.index;n!==null&&this.setIndex(n.clone());const i=e.attributes;for(const c in i){const h=i[c];this.setAttribute(c,h.clone(t))}const r=e.morphAttributes;for(const c in r){const h=[],u=r[c];for(let d=0,f=u.length;d<f;d++)h.push(u[d].clone(t));this.morphAttributes[c]=h}this.morphTargetsRelative=e.morphTargetsRelative;const a=e.groups;for(let c=0,h=a.length;c<h;c++){const u=a[c];this.addGroup(u.start,u.count,u.materialIndex)}const o=e.boundingBox;o!==null&&(this.boundingBox=o.clone());const l=e.boundingSphere;return l!==null&&(this.boundingSphere=l.clone()),this.drawRange.start=e.drawRange.start,this.drawRange.count=e.drawRange.count,this.userData=e.userData,this._transformed=e._transformed,this}dispose(){this.dispatchEvent({type:"dispose"})}}const _r=new D,Kl=new D,Zl=new Ue;class wn{constructor(e=new D(1,0,0),t=0){this.isPlane=!0,this.normal=e,this.constant=t}set(e,t){return this.normal.copy(e),this.constant=t,this}setComponents(e,t,n,i){return this.normal.set(e,t,n),this.constant=i,this}setFromNormalAndCoplanarPoint(e,t){return this.normal.copy(e),this.constant=-t.dot(this.normal),this}setFromCoplanarPoints(e,t,n){const i=_r.subVectors(n,t).cross(Kl.subVectors(e,t)).normalize();return this.setFromNormalAndCoplanarPoint(i,e),this}copy(e){return this.normal.copy(e.normal),this.constant=e.constant,this}normalize(){const e=1/this.normal.length();return this.normal.multiplyScalar(e),this.constant*=e,this}negate(){return this.constant*=-1,this.normal.negate(),this}distanceToPoint(e){return this.normal.dot(e)+this.constant}distanceToSphere(e){return this.distanceToPoint(e.center)-e.radius}projectPoint(e,t){return t.copy(e).addScaledVector(this.normal,-this.distanceToPoint(e))}intersectLine(e,t,n=!0){const i=e.delta(_r),r=this.normal.dot(i);if(r===0)return this.distanceToPoint(e.start)===0?t.copy(e.start):null;const a=-(e.start.dot(this.normal)+this.constant)/r;return n===!0&&(a<0||a>1)?null:t.copy(e.start).addScaledVector(i,a)}intersectsLine(e){const t=this.distanceToPoint(e.start),n=this.distanceToPoint(e.end);return t<0&&n>0||n<0&&t>0}intersectsBox(e){return e.intersectsPlane(this)}intersectsSphere(e){return e.intersectsPlane(this)}coplanarPoint(e){return e.copy(this.normal).multiplyScalar(-this.constant)}applyMatrix4(e,t){const n=t||Zl.getNormalMatrix(e),i=this.coplanarPoint(_r).applyMatrix4(e),r=this.normal.applyMatrix3(n).normalize();return this.constant=-i.dot(r),this}translate(e){return this.constant-=e.dot(this.normal),this}equals(e){return e.normal.equals(this.normal)&&e.constant===this.constant}clone(){return new this.constructor().copy(this)}toJSON(){return{normal:this.normal.toArray(),constant:this.constant}}fromJSON(e){return this.normal.fromArray(e.normal),this.constant=e.constant,this}}let Jl=0;class xi extends Jn{constructor(){super(),this.isMaterial=!0,Object.defineProperty(this,"id",{value:Jl++}),this.uuid=zi(),this.name="",this.type="Material",this.blending=1,this.side=0,this.vertexColors=!1,this.opacity=1,this.transparent=!1,this.alphaHash=!1,this.blendSrc=204,this.blendDst=205,this.blendEquation=100,this.blendSrcAlpha=null,this.blendDstAlpha=null,this.blendEquationAlpha=null,this.blendColor=new Xe(0,0,0),this.blendAlpha=0,this.depthFunc=3,this.depthTest=!0,this.depthWrite=!0,this.stencilWriteMask=255,this.stencilFunc=519,this.stencilRef=0,this.stencilFuncMask=255,this.stencilFail=7680,this.stencilZFail=7680,this.stencilZPass=7680,this.stencilWrite=!1,this.clippingPlanes=null,this.clipIntersection=!1,this.clipShadows=!1,this.shadowSide=null,this.colorWrite=!0,this.precision=null,this.polygonOffset=!1,this.polygonOffsetFactor=0,this.polygonOffsetUnits=0,this.dithering=!1,this.alphaToCoverage=!1,this.premultipliedAlpha=!1,this.forceSinglePass=!1,this.allowOverride=!0,this.visible=!0,this.toneMapped=!0,this.userData={},this.version=0,this._alphaTest=0}get alphaTest(){return this._alphaTest}set alphaTest(e){this._alphaTest>0!=e>0&&this.version++,this._alphaTest=e}onBeforeRender(){}onBeforeCompile(){}customProgramCacheKey(){return this.onBeforeCompile.toString()}setValues(e){if(e!==void 0)for(const t in e){const n=e[t];if(n===void 0){Le(`Material: parameter '${t}' has value of undefined.`);continue}const i=this[t];if(i===void 0){Le(`Material: '${t}' is not a property of THREE.${this.type}.`);continue}i&&i.isColor?i.set(n):i&&i.isVector2&&n&&n.isVector2||i&&i.isEuler&&n&&n.isEuler||i&&i.isVector3&&n&&n.isVector3?i.copy(n):this[t]=n}}toJSON(e){const t=e===void 0||typeof e=="string";t&&(e={textures:{},images:{}});const n={metadata:{version:4.7,type:"Material",generator:"Material.toJSON"}};n.uuid=this.uuid,n.type=this.type,n.blending=this.blending,n.side=this.side,n.shadowSide=this.shadowSide,n.vertexColors=this.vertexColors,n.opacity=this.opacity,n.transparent=this.transparent,n.blendSrc=this.blendSrc,n.blendDst=this.blendDst,n.blendEquation=this.blendEquation,n.blendSrcAlpha=this.blendSrcAlpha,n.blendDstAlpha=this.blendDstAlpha,n.blendEquationAlpha=this.blendEquationAlpha,n.blendColor=this.blendColor.getHex(),n.blendAlpha=this.blendAlpha,n.depthFunc=this.depthFunc,n.depthTest=this.depthTest,n.depthWrite=this.depthWrite,n.colorWrite=this.colorWrite,n.clipIntersection=this.clipIntersection,n.clipShadows=this.clipShadows,n.stencilWriteMask=this.stencilWriteMask,n.stencilFunc=this.stencilFunc,n.stencilRef=this.stencilRef,n.stencilFuncMask=this.stencilFuncMask,n.stencilFail=this.stencilFail,n.stencilZFail=this.stencilZFail,n.stencilZPass=this.stencilZPass,n.stencilWrite=this.stencilWrite,n.polygonOffset=this.polygonOffset,n.polygonOffsetFactor=this.polygonOffsetFactor,n.polygonOffsetUnits=this.polygonOffsetUnits,n.dithering=this.dithering,n.alphaTest=this.alphaTest,n.alphaHash=this.alphaHash,n.alphaToCoverage=this.alphaToCoverage,n.premultipliedAlpha=this.premultipliedAlpha,n.forceSinglePass=this.forceSinglePass,n.allowOverride=this.allowOverride,n.visible=this.visible,n.toneMapped=this.toneMapped,n.name=this.name,this.color&&this.color.isColor&&(n.color=this.color.getHex()),this.roughness!==void 0&&(n.roughness=this.roughness),this.metalness!==void 0&&(n.metalness=this.metalness),this.sheen!==void 0&&(n.sheen=this.sheen),this.sheenColor&&this.sheenColor.isColor&&(n.sheenColor=this.sheenColor.getHex()),this.sheenRoughness!==void 0&&(n.sheenRoughness=this.sheenRoughness),this.emissive&&this.emissive.isColor&&(n.emissive=this.emissive.getHex()),this.emissiveIntensity!==void 0&&(n.emissiveIntensity=this.emissiveIntensity),this.specular&&this.specular.isColor&&(n.specular=this.specular.getHex()),this.specularIntensity!==void 0&&(n.specularIntensity=this.specularIntensity),this.specularColor&&this.specularColor.isColor&&(n.specularColor=this.specularColor.getHex()),this.shininess!==void 0&&(n.shininess=this.shininess),this.clearcoat!==void 0&&(n.clearcoat=this.clearcoat),this.clearcoatRoughness!==void 0&&(n.clearcoatRoughness=this.clearcoatRoughness),this.diffuseRoughness!==void 0&&(n.diffuseRoughness=this.diffuseRoughness),this.diffuseRoughnessMap&&this.diffuseRoughnessMap.isTexture&&(n.diffuseRoughnessMap=this.diffuseRoughnessMap.toJSON(e).uuid),this.clearcoatMap&&this.clearcoatMap.isTexture&&(n.clearcoatMap=this.clearcoatMap.toJSON(e).uuid),this.clearcoatRoughnessMap&&this.clearcoatRoughnessMap.isTexture&&(n.clearcoatRoughnessMap=this.clearcoatRoughnessMap.toJSON(e).uuid),this.clearcoatNormalMap&&this.clearcoatNormalMap.isTexture&&(n.clearcoatNormalMap=this.clearcoatNormalMap.toJSON(e).uuid,n.clearcoatNormalScale=this.clearcoatNormalScale.toArray()),this.sheenColorMap&&this.sheenColorMap.isTexture&&(n.sheenColorMap=this.sheenColorMap.toJSON(e).uuid),this.sheenRoughnessMap&&this.sheenRoughnessMap.isTexture&&(n.sheenRoughnessMap=this.sheenRoughnessMap.toJSON(e).uuid),this.dispersion!==void 0&&(n.dispersion=this.dispersion),this.retroreflectivity!==void 0&&(n.retroreflectivity=this.retroreflectivity),this.iridescence!==void 0&&(n.iridescence=this.iridescence),this.iridescenceIOR!==void 0&&(n.iridescenceIOR=this.iridescenceIOR),this.iridescenceThicknessMinimum!==void 0&&(n.iridescenceThicknessMinimum=this.iridescenceThicknessMinimum),this.iridescenceThicknessMaximum!==void 0&&(n.iridescenceThicknessMaximum=this.iridescenceThicknessMaximum),this.iridescenceMap&&this.iridescenceMap.isTexture&&(n.iridescenceMap=this.iridescenceMap.toJSON(e).uuid),this.iridescenceThicknessMap&&this.iridescenceThicknessMap.isTexture&&(n.iridescenceThicknessMap=this.iridescenceThicknessMap.toJSON(e).uuid),this.anisotropy!==void 0&&(n.anisotropy=this.anisotropy),this.anisotropyRotation!==void 0&&(n.anisotropyRotation=this.anisotropyRotation),this.anisotropyMap&&this.anisotropyMap.isTexture&&(n.anisotropyMap=this.anisotropyMap.toJSON(e).uuid),this.map&&this.map.isTexture&&(n.map=this.map.toJSON(e).uuid),this.matcap&&this.matcap.isTexture&&(n.matcap=this.matcap.toJSON(e).uuid),this.alphaMap&&this.alphaMap.isTexture&&(n.alphaMap=this.alphaMap.toJSON(e).uuid),this.lightMap&&this.lightMap.isTexture&&(n.lightMap=this.lightMap.toJSON(e).uuid,n.lightMapIntensity=this.lightMapIntensity),this.aoMap&&this.aoMap.isTexture&&(n.aoMap=this.aoMap.toJSON(e).uuid,n.aoMapIntensity=this.aoMapIntensity),this.bumpMap&&this.bumpMap.isTexture&&(n.bumpMap=this.bumpMap.toJSON(e).uuid,n.bumpScale=this.bumpScale),this.normalMap&&this.normalMap.isTexture&&(n.normalMap=this.normalMap.toJSON(e).uuid,n.normalMapType=this.normalMapType,n.normalScale=this.normalScale.toArray()),this.displacementMap&&this.displacementMap.isTexture&&(n.displacementMap=this.displacementMap.toJSON(e).uuid,n.displacementScale=this.displacementScale,n.displacementBias=this.displacementBias),this.roughnessMap&&this.roughnessMap.isTexture&&(n.roughnessMap=this.roughnessMap.toJSON(e).uuid),this.metalnessMap&&this.metalnessMap.isTexture&&(n.metalnessMap=this.metalnessMap.toJSON(e).uuid),this.emissiveMap&&this.emissiveMap.isTexture&&(n.emissiveMap=this.emissiveMap.toJSON(e).uuid),this.specularMap&&this.specularMap.isTexture&&(n.specularMap=this.specularMap.toJSON(e).uuid),this.specularIntensityMap&&this.specularIntensityMap.isTexture&&(n.specularIntensityMap=this.specularIntensityMap.toJSON(e).uuid),this.specularColorMap&&this.specularColorMap.isTexture&&(n.specularColorMap=this.specularColorMap.toJSON(e).uuid),this.envMap&&this.envMap.isTexture&&(n.envMap=this.envMap.toJSON(e).uuid,this.combine!==void 0&&(n.combine=this.combine)),this.envMapRotation!==void 0&&(n.envMapRotation=this.envMapRotation.toArray()),this.envMapIntensity!==void 0&&(n.envMapIntensity=this.envMapIntensity),this.reflectivity!==void 0&&(n.reflectivity=this.reflectivity),this.refractionRatio!==void 0&&(n.refractionRatio=this.refractionRatio),this.gradientMap&&this.gradientMap.isTexture&&(n.gradientMap=this.gradientMap.toJSON(e).uuid),this.transmission!==void 0&&(n.transmission=this.transmission),this.transmissionMap&&this.transmissionMap.isTexture&&(n.transmissionMap=this.transmissionMap.toJSON(e).uuid),this.thickness!==void 0&&(n.thickness=this.thickness),this.thicknessMap&&this.thicknessMap.isTexture&&(n.thicknessMap=this.thicknessMap.toJSON(e).uuid),this.attenuationDistance!==void 0&&(n.attenuationDistance=this.attenuationDistance),this.attenuationColor!==void 0&&(n.attenuationColor=this.attenuationColor.getHex()),this.size!==void 0&&(n.size=this.size),this.sizeAttenuation!==void 0&&(n.sizeAttenuation=this.sizeAttenuation),Array.isArray(this.clippingPlanes)&&this.clippingPlanes.length>0&&(n.clippingPlanes=this.clippingPlanes.map(r=>r.toJSON())),this.rotation!==void 0&&(n.rotation=this.rotation),this.depthPacking!==void 0&&(n.depthPacking=this.depthPacking),this.linewidth!==void 0&&(n.linewidth=this.linewidth),this.linecap!==void 0&&(n.linecap=this.linecap),this.linejoin!==void 0&&(n.linejoin=this.linejoin),this.dashSize!==void 0&&(n.dashSize=this.dashSize),this.gapSize!==void 0&&(n.gapSize=this.gapSize),this.scale!==void 0&&(n.scale=this.scale),this.wireframe!==void 0&&(n.wireframe=this.wireframe),this.wireframeLinewidth!==void 0&&(n.wireframeLinewidth=this.wireframeLinewidth),this.wireframeLinecap!==void 0&&(n.wireframeLinecap=this.wireframeLinecap),this.wireframeLinejoin!==void 0&&(n.wireframeLinejoin=this.wireframeLinejoin),this.flatShading!==void 0&&(n.flatShading=this.flatShading),this.fog!==void 0&&(n.fog=this.fog),Object.keys(this.userData).length>0&&(n.userData=this.userData);function i(r){const a=[];for(const o in r){const l=r[o];delete l.metadata,a.push(l)}return a}if(t){const r=i(e.textures),a=i(e.images);r.length>0&&(n.textures=r),a.length>0&&(n.images=a)}return n}fromJSON(e,t){if(e.uuid!==void 0&&(this.uuid=e.uuid),e.name!==void 0&&(this.name=e.name),e.color!==void 0&&this.color!==void 0&&this.color.setHex(e.color),e.roughness!==void 0&&(this.roughness=e.roughness),e.metalness!==void 0&&(this.metalness=e.metalness),e.sheen!==void 0&&(this.sheen=e.sheen),e.sheenColor!==void 0&&(this.sheenColor=new Xe().setHex(e.sheenColor)),e.sheenRoughness!==void 0&&(this.sheenRoughness=e.sheenRoughness),e.emissive!==void 0&&this.emissive!==void 0&&this.emissive.setHex(e.emissive),e.specular!==void 0&&this.specular!==void 0&&this.specular.setHex(e.specular),e.specularIntensity!==void 0&&(this.specularIntensity=e.specularIntensity),e.specularColor!==void 0&&this.specularColor!==void 0&&this.specularColor.setHex(e.specularColor),e.shininess!==void 0&&(this.shininess=e.shininess),e.clearcoat!==void 0&&(this.clearcoat=e.clearcoat),e.clearcoatRoughness!==void 0&&(this.clearcoatRoughness=e.clearcoatRoughness),e.diffuseRoughness!==void 0&&(this.diffuseRoughness=e.diffuseRoughness),e.dispersion!==void 0&&(this.dispersion=e.dispersion),e.retroreflectivity!==void 0&&(this.retroreflectivity=e.retroreflectivity),e.iridescence!==void 0&&(this.iridescence=e.iridescence),e.iridescenceIOR!==void 0&&(this.iridescenceIOR=e.iridescenceIOR),e.iridescenceThicknessMinimum!==void 0&&(this.iridescenceThicknessMinimum=e.iridescenceThicknessMinimum),e.iridescenceThicknessMaximum!==void 0&&(this.iridescenceThicknessMaximum=e.iridescenceThicknessMaximum),e.iridescenceThicknessRange!==void 0&&(this.iridescenceThicknessMinimum=e.iridescenceThicknessRange[0],this.iridescenceThicknessMaximum=e.iridescenceThicknessRange[1]),e.transmission!==void 0&&(this.transmission=e.transmission),e.thickness!==void 0&&(this.thickness=e.thickness),e.attenuationDistance!==void 0&&(this.attenuationDistance=e.attenuationDistance),e.attenuationColor!==void 0&&this.attenuationColor!==void 0&&this.attenuationColor.setHex(e.attenuationColor),e.anisotropy!==void 0&&(this.anisotropy=e.anisotropy),e.anisotropyRotation!==void 0&&(this.anisotropyRotation=e.anisotropyRotation),e.fog!==void 0&&(this.fog=e.fog),e.flatShading!==void 0&&(this.flatShading=e.flatShading),e.blending!==void 0&&(this.blending=e.blending),e.combine!==void 0&&(this.combine=e.combine),e.side!==void 0&&(this.side=e.side),e.shadowSide!==void 0&&(this.shadowSide=e.shadowSide),e.opacity!==void 0&&(this.opacity=e.opacity),e.transparent!==void 0&&(this.transparent=e.transparent),e.alphaTest!==void 0&&(this.alphaTest=e.alphaTest),e.alphaHash!==void 0&&(this.alphaHash=e.alphaHash),e.depthFunc!==void 0&&(this.depthFunc=e.depthFunc),e.depthTest!==void 0&&(this.depthTest=e.depthTest),e.depthWrite!==void 0&&(this.depthWrite=e.depthWrite),e.colorWrite!==void 0&&(this.colorWrite=e.colorWrite),e.clippingPlanes!==void 0&&(this.clippingPlanes=e.clippingPlanes.map(n=>new wn().fromJSON(n))),e.clipIntersection!==void 0&&(this.clipIntersection=e.clipIntersection),e.clipShadows!==void 0&&(this.clipShadows=e.clipShadows),e.depthPacking!==void 0&&(this.depthPacking=e.depthPacking),e.blendSrc!==void 0&&(this.blendSrc=e.blendSrc),e.blendDst!==void 0&&(this.blendDst=e.blendDst),e.blendEquation!==void 0&&(this.blendEquation=e.blendEquation),e.blendSrcAlpha!==void 0&&(this.blendSrcAlpha=e.blendSrcAlpha),e.blendDstAlpha!==void 0&&(this.blendDstAlpha=e.blendDstAlpha),e.blendEquationAlpha!==void 0&&(this.blendEquationAlpha=e.blendEquationAlpha),e.blendColor!==void 0&&this.blendColor!==void 0&&this.blendColor.setHex(e.blendColor),e.blendAlpha!==void 0&&(this.blendAlpha=e.blendAlpha),e.stencilWriteMask!==void 0&&(this.stencilWriteMask=e.stencilWriteMask),e.stencilFunc!==void 0&&(this.stencilFunc=e.stencilFunc),e.stencilRef!==void 0&&(this.stencilRef=e.stencilRef),e.stencilFuncMask!==void 0&&(this.stencilFuncMask=e.stencilFuncMask),e.stencilFail!==void 0&&(this.stencilFail=e.stencilFail),e.stencilZFail!==void 0&&(this.stencilZFail=e.stencilZFail),e.stencilZPass!==void 0&&(this.stencilZPass=e.stencilZPass),e.stencilWrite!==void 0&&(this.stencilWrite=e.stencilWrite),e.wireframe!==void 0&&(this.wireframe=e.wireframe),e.wireframeLinewidth!==void 0&&(this.wireframeLinewidth=e.wireframeLinewidth),e.wireframeLinecap!==void 0&&(this.wireframeLinecap=e.wireframeLinecap),e.wireframeLinejoin!==void 0&&(this.wireframeLinejoin=e.wireframeLinejoin),e.rotation!==void 0&&(this.rotation=e.rotation),e.linewidth!==void 0&&(this.linewidth=e.linewidth),e.linecap!==void 0&&(this.linecap=e.linecap),e.linejoin!==void 0&&(this.linejoin=e.linejoin),e.dashSize!==void 0&&(this.dashSize=e.dashSize),e.gapSize!==void 0&&(this.gapSize=e.gapSize),e.scale!==void 0&&(this.scale=e.scale),e.polygonOffset!==void 0&&(this.polygonOffset=e.polygonOffset),e.polygonOffsetFactor!==void 0&&(this.polygonOffsetFactor=e.polygonOffsetFactor),e.polygonOffsetUnits!==void 0&&(this.polygonOffsetUnits=e.polygonOffsetUnits),e.dithering!==void 0&&(this.dithering=e.dithering),e.alphaToCoverage!==void 0&&(this.alphaToCoverage=e.alphaToCoverage),e.premultipliedAlpha!==void 0&&(this.premultipliedAlpha=e.premultipliedAlpha),e.forceSinglePass!==void 0&&(this.forceSinglePass=e.forceSinglePass),e.allowOverride!==void 0&&(this.allowOverride=e.allowOverride),e.visible!==void 0&&(this.visible=e.visible),e.toneMapped!==void 0&&(this.toneMapped=e.toneMapped),e.userData!==void 0&&(this.userData=e.userData),e.vertexColors!==void 0&&(typeof e.vertexColors=="number"?this.vertexColors=e.vertexColors>0:this.vertexColors=e.vertexColors),e.size!==void 0&&(this.size=e.size),e.sizeAttenuation!==void 0&&(this.sizeAttenuation=e.sizeAttenuation),e.map!==void 0&&(this.map=t[e.map]||null),e.matcap!==void 0&&(this.matcap=t[e.matcap]||null),e.alphaMap!==void 0&&(this.alphaMap=t[e.alphaMap]||null),e.bumpMap!==void 0&&(this.bumpMap=t[e.bumpMap]||null),e.bumpScale!==void 0&&(this.bumpScale=e.bumpScale),e.normalMap!==void 0&&(this.normalMap=t[e.normalMap]||null),e.normalMapType!==void 0&&(this.normalMapType=e.normalMapType),e.normalScale!==void 0){let n=e.normalScale;Array.isArray(n)===!1&&(n=[n,n]),this.normalScale=new Ye().fromArray(n)}return e.displacementMap!==void 0&&(this.displacementMap=t[e.displacementMap]||null),e.displacementScale!==void 0&&(this.displacementScale=e.displacementScale),e.displacementBias!==void 0&&(this.displacementBias=e.displacementBias),e.roughnessMap!==void 0&&(this.roughnessMap=t[e.roughnessMap]||null),e.metalnessMap!==void 0&&(this.metalnessMap=t[e.metalnessMap]||null),e.emissiveMap!==void 0&&(this.emissiveMap=t[e.emissiveMap]||null),e.emissiveIntensity!==void 0&&(this.emissiveIntensity=e.emissiveIntensity),e.specularMap!==void 0&&(this.specularMap=t[e.specularMap]||null),e.specularIntensityMap!==void 0&&(this.specularIntensityMap=t[e.specularIntensityMap]||null),e.specularColorMap!==void 0&&(this.specularColorMap=t[e.specularColorMap]||null),e.envMap!==void 0&&(this.envMap=t[e.envMap]||null),e.envMapRotation!==void 0&&this.envMapRotation.fromArray(e.envMapRotation),e.envMapIntensity!==void 0&&(this.envMapIntensity=e.envMapIntensity),e.reflectivity!==void 0&&(this.reflectivity=e.reflectivity),e.refractionRatio!==void 0&&(this.refractionRatio=e.refractionRatio),e.lightMap!==void 0&&(this.lightMap=t[e.lightMap]||null),e.lightMapIntensity!==void 0&&(this.lightMapIntensity=e.lightMapIntensity),e.aoMap!==void 0&&(this.aoMap=t[e.aoMap]||null),e.aoMapIntensity!==void 0&&(this.aoMapIntensity=e.aoMapIntensity),e.gradientMap!==void 0&&(this.gradientMap=t[e.gradientMap]||null),e.clearcoatMap!==void 0&&(this.clearcoatMap=t[e.clearcoatMap]||null),e.clearcoatRoughnessMap!==void 0&&(this.clearcoatRoughnessMap=t[e.clearcoatRoughnessMap]||null),e.clearcoatNormalMap!==void 0&&(this.clearcoatNormalMap=t[e.clearcoatNormalMap]||null),e.clearcoatNormalScale!==void 0&&(this.clearcoatNormalScale=new Ye().fromArray(e.clearcoatNormalScale)),e.diffuseRoughnessMap!==void 0&&(this.diffuseRoughnessMap=t[e.diffuseRoughnessMap]||null),e.iridescenceMap!==void 0&&(this.iridescenceMap=t[e.iridescenceMap]||null),e.iridescenceThicknessMap!==void 0&&(this.iridescenceThicknessMap=t[e.iridescenceThicknessMap]||null),e.transmissionMap!==void 0&&(this.transmissionMap=t[e.transmissionMap]||null),e.thicknessMap!==void 0&&(this.thicknessMap=t[e.thicknessMap]||null),e.anisotropyMap!==void 0&&(this.anisotropyMap=t[e.anisotropyMap]||null),e.sheenColorMap!==void 0&&(this.sheenColorMap=t[e.sheenColorMap]||null),e.sheenRoughnessMap!==void 0&&(this.sheenRoughnessMap=t[e.sheenRoughnessMap]||null),this}clone(){return new this.constructor().copy(this)}copy(e){this.name=e.name,this.blending=e.blending,this.side=e.side,this.vertexColors=e.vertexColors,this.opacity=e.opacity,this.transparent=e.transparent,this.blendSrc=e.blendSrc,this.blendDst=e.blendDst,this.blendEquation=e.blendEquation,this.blendSrcAlpha=e.blendSrcAlpha,this.blendDstAlpha=e.blendDstAlpha,this.blendEquationAlpha=e.blendEquationAlpha,this.blendColor.copy(e.blendColor),this.blendAlpha=e.blendAlpha,this.depthFunc=e.depthFunc,this.depthTest=e.depthTest,this.depthWrite=e.depthWrite,this.stencilWriteMask=e.stencilWriteMask,this.stencilFunc=e.stencilFunc,this.stencilRef=e.stencilRef,this.stencilFuncMask=e.stencilFuncMask,this.stencilFail=e.stencilFail,this.stencilZFail=e.stencilZFail,this.stencilZPass=e.stencilZPass,this.stencilWrite=e.stencilWrite;const t=e.clippingPlanes;let n=null;if(t!==null){const i=t.length;n=new Array(i);for(let r=0;r!==i;++r)n[r]=t[r].clone()}return this.clippingPlanes=n,this.clipIntersection=e.clipIntersection,this.clipShadows=e.clipShadows,this.shadowSide=e.shadowSide,this.colorWrite=e.colorWrite,this.precision=e.precision,this.polygonOffset=e.polygonOffset,this.polygonOffsetFactor=e.polygonOffsetFactor,this.polygonOffsetUnits=e.polygonOffsetUnits,this.dithering=e.dithering,this.alphaTest=e.alphaTest,this.alphaHash=e.alphaHash,this.alphaToCoverage=e.alphaToCoverage,this.premultipliedAlpha=e.premultipliedAlpha,this.forceSinglePass=e.forceSinglePass,this.allowOverride=e.allowOverride,this.visible=e.visible,this.toneMapped=e.toneMapped,this.userData=JSON.parse(JSON.stringify(e.userData)),this}dispose(){this.dispatchEvent({type:"dispose"})}set needsUpdate(e){e===!0&&this.version++}}const Mn=new D,vr=new D,ji=new D,es=new D;class zs{constructor(e=new D,t=new D(0,0,-1)){this.origin=e,this.direction=t}set(e,t){return this.origin.copy(e),this.direction.copy(t),this}copy(e){return this.origin.copy(e.origin),this.direction.copy(e.direction),this}at(e,t){return t.copy(this.origin).addScaledVector(this.direction,e)}lookAt(e){return this.direction.copy(e).sub(this.origin).normalize(),this}recast(e){return this.origin.copy(this.at(e,Mn)),this}closestPointToPoint(e,t){t.subVectors(e,this.origin);const n=t.dot(this.direction);return n<0?t.copy(this.origin):t.copy(this.origin).addScaledVector(this.direction,n)}distanceToPoint(e){return Math.sqrt(this.distanceSqToPoint(e))}distanceSqToPoint(e){const t=Mn.subVectors(e,this.origin).dot(this.direction);return t<0?this.origin.distanceToSquared(e):(Mn.copy(this.origin).addScaledVector(this.direction,t),Mn.distanceToSquared(e))}distanceSqToSegment(e,t,n,i){vr.copy(e).add(t).multiplyScalar(.5),ji.copy(t).sub(e).normalize(),es.copy(this.origin).sub(vr);const r=e.distanceTo(t)*.5,a=-this.direction.dot(ji),o=es.dot(this.direction),l=-es.dot(ji),c=es.lengthSq(),h=Math.abs(1-a*a);let u,d,f,g;if(h>0)if(u=a*l-o,d=a*o-l,g=r*h,u>=0)if(d>=-g)if(d<=g){const S=1/h;u*=S,d*=S,f=u*(u+a*d+2*o)+d*(a*u+d+2*l)+c}else d=r,u=Math.max(0,-(a*d+o)),f=-u*u+d*(d+2*l)+c;else d=-r,u=Math.max(0,-(a*d+o)),f=-u*u+d*(d+2*l)+c;else d<=-g?(u=Math.max(0,-(-a*r+o)),d=u>0?-r:Math.min(Math.max(-r,-l),r),f=-u*u+d*(d+2*l)+c):d<=g?(u=0,d=Math.min(Math.max(-r,-l),r),f=d*(d+2*l)+c):(u=Math.max(0,-(a*r+o)),d=u>0?r:Math.min(Math.max(-r,-l),r),f=-u*u+d*(d+2*l)+c);else d=a>0?-r:r,u=Math.max(0,-(a*d+o)),f=-u*u+d*(d+2*l)+c;return n&&n.copy(this.origin).addScaledVector(this.direction,u),i&&i.copy(vr).addScaledVector(ji,d),f}intersectSphere(e,t){if(e.radius<0)return null;Mn.subVectors(e.center,this.origin);const n=Mn.dot(this.direction),i=Mn.dot(Mn)-n*n,r=e.radius*e.radius;if(i>r)return null;const a=Math.sqrt(r-i),o=n-a,l=n+a;return l<0?null:o<0?this.at(l,t):this.at(o,t)}intersectsSphere(e){return e.radius<0?!1:this.distanceSqToPoint(e.center)<=e.radius*e.radius}distanceToPlane(e){const t=e.normal.dot(this.direction);if(t===0)return e.distanceToPoint(this.origin)===0?0:null;const n=-(this.origin.dot(e.normal)+e.constant)/t;return n>=0?n:null}intersectPlane(e,t){const n=this.distanceToPlane(e);return n===null?null:this.at(n,t)}intersectsPlane(e){const t=e.distanceToPoint(this.origin);return t===0||e.normal.dot(this.direction)*t<0}intersectBox(e,t){let n,i,r,a,o,l;const c=1/this.direction.x,h=1/this.direction.y,u=1/this.direction.z,d=this.origin;return c>=0?(n=(e.min.x-d.x)*c,i=(e.max.x-d.x)*c):(n=(e.max.x-d.x)*c,i=(e.min.x-d.x)*c),h>=0?(r=(e.min.y-d.y)*h,a=(e.max.y-d.y)*h):(r=(e.max.y-d.y)*h,a=(e.min.y-d.y)*h),n>a||r>i||((r>n||isNaN(n))&&(n=r),(a<i||isNaN(i))&&(i=a),u>=0?(o=(e.min.z-d.z)*u,l=(e.max.z-d.z)*u):(o=(e.max.z-d.z)*u,l=(e.min.z-d.z)*u),n>l||o>i)||((o>n||n!==n)&&(n=o),(l<i||i!==i)&&(i=l),i<0)?null:this.at(n>=0?n:i,t)}intersectsBox(e){return this.intersectBox(e,Mn)!==null}intersectTriangle(e,t,n,i,r){const a=this.origin,o=this.direction,l=o.x,c=o.y,h=o.z,u=e.x-a.x,d=e.y-a.y,f=e.z-a.z,g=t.x-a.x,S=t.y-a.y,m=t.z-a.z,p=n.x-a.x,M=n.y-a.y,A=n.z-a.z,b=Math.abs(l),R=Math.abs(c),E=Math.abs(h);let _,y,k,N,I,z,$,P,W,Z,H,te;if(b>=R&&b>=E?(k=l,z=u,W=g,te=p,l>=0?(_=c,y=h,N=d,I=f,$=S,P=m,Z=M,H=A):(_=h,y=c,N=f,I=d,$=m,P=S,Z=A,H=M)):R>=E?(k=c,z=d,W=S,te=M,c>=0?(_=h,y=l,N=f,I=u,$=m,P=g,Z=A,H=p):(_=l,y=h,N=u,I=f,$=g,P=m,Z=p,H=A)):(k=h,z=f,W=m,te=A,h>=0?(_=l,y=c,N=u,I=d,$=g,P=S,Z=p,H=M):(_=c,y=l,N=d,I=u,$=S,P=g,Z=M,H=p)),k===0)return null;const V=_/k,j=y/k,ee=1/k,we=N-V*z,Pe=I-j*z,q=$-V*W,he=P-j*W,ve=Z-V*te,Ee=H-j*te,fe=ve*he-Ee*q,De=we*Ee-Pe*ve,Ke=q*Pe-he*we;if(i){if(fe<0||De<0||Ke<0)return null}else if((fe<0||De<0||Ke<0)&&(fe>0||De>0||Ke>0))return null;const Te=fe+De+Ke;if(Te===0)return null;const He=ee*(fe*z+De*W+Ke*te);return(Te>0?He<0:He>0)?null:this.at(He/Te,r)}applyMatrix4(e){return this.origin.applyMatrix4(e),this.direction.transformDirection(e),this}equals(e){return e.origin.equals(this.origin)&&e.direction.equals(this.direction)}clone(){return new this.constructor().copy(this)}}class Ql extends xi{constructor(e){super(),this.isMeshBasicMaterial=!0,this.type="MeshBasicMaterial",this.color=new Xe(16777215),this.map=null,this.lightMap=null,this.lightMapIntensity=1,this.aoMap=null,this.aoMapIntensity=1,this.specularMap=null,this.alphaMap=null,this.envMap=null,this.envMapRotation=new Yn,this.combine=0,this.reflectivity=1,this.refractionRatio=.98,this.wireframe=!1,this.wireframeLinewidth=1,this.wireframeLinecap="round",this.wireframeLinejoin="round",this.fog=!0,this.setValues(e)}copy(e){return super.copy(e),this.color.copy(e.color),this.map=e.map,this.lightMap=e.lightMap,this.lightMapIntensity=e.lightMapIntensity,this.aoMap=e.aoMap,this.aoMapIntensity=e.aoMapIntensity,this.specularMap=e.specularMap,this.alphaMap=e.alphaMap,this.envMap=e.envMap,this.envMapRotation.copy(e.envMapRotation),this.combine=e.combine,this.reflectivity=e.reflectivity,this.refractionRatio=e.refractionRatio,this.wireframe=e.wireframe,this.wireframeLinewidth=e.wireframeLinewidth,this.wireframeLinecap=e.wireframeLinecap,this.wireframeLinejoin=e.wireframeLinejoin,this.fog=e.fog,this}}const ya=new Qe,Hn=new zs,ts=new Qn,ba=new D,ns=new D,is=new D,ss=new D,xr=new D,rs=new D,Ea=new D,as=new D;class fn extends It{constructor(e=new ht,t=new Ql){super(),this.isMesh=!0,this.type="Mesh",this.geometry=e,this.material=t,this.morphTargetDictionary=void 0,this.morphTargetInfluences=void 0,this.count=1,this.updateMorphTargets()}copy(e,t){return super.copy(e,t),e.morphTargetInfluences!==void 0?this.morphTargetInfluences=e.morphTargetInfluences.slice():this.morphTargetInfluences=void 0,e.morphTargetDictionary!==void 0?this.morphTargetDictionary=Object.assign({},e.morphTargetDictionary):this.morphTargetDictionary=void 0,this.material=Array.isArray(e.material)?e.material.slice():e.material,this.geometry=e.geometry,this}updateMorphTargets(){const t=this.geometry.morphAttributes,n=Object.keys(t);if(n.length>0){const i=t[n[0]];if(i!==void 0){this.morphTargetInfluences=[],this.morphTargetDictionary={};for(let r=0,a=i.length;r<a;r++){const o=i[r].name||String(r);this.morphTargetInfluences.push(0),this.morphTargetDictionary[o]=r}}}}getVertexPosition(e,t){const n=this.geometry,i=n.attributes.position,r=n.morphAttributes.position,a=n.morphTargetsRelative;t.fromBufferAttribute(i,e);const o=this.morphTargetInfluences;if(r&&o){rs.set(0,0,0);for(let l=0,c=r.length;l<c;l++){const h=o[l],u=r[l];h!==0&&(xr.fromBufferAttribute(u,e),a?rs.addScaledVector(xr,h):rs.addScaledVector(xr.sub(t),h))}t.add(rs)}return t}intersectsFrustum(e){return e.intersectsObject(this)}raycast(e,t){const n=this.geometry,i=this.material,r=this.matrixWorld;i!==void 0&&(n.boundingSphere===null&&n.computeBoundingSphere(),ts.copy(n.boundingSphere),ts.applyMatrix4(r),Hn.copy(e.ray).recast(e.near),!(ts.containsPoint(Hn.origin)===!1&&(Hn.intersectSphere(ts,ba)===null||Hn.origin.distanceToSquared(ba)>(e.far-e.near)**2))&&(ya.copy(r).invert(),Hn.copy(e.ray).applyMatrix4(ya),!(n.boundingBox!==null&&Hn.intersectsBox(n.boundingBox)===!1)&&this._computeIntersections(e,t,Hn)))}_computeIntersections(e,t,n){let i;const r=this.geometry,a=this.material,o=r.index,l=r.attributes.position,c=r.attributes.uv,h=r.attributes.uv1,u=r.attributes.normal,d=r.groups,f=r.drawRange;if(o!==null)if(Array.isArray(a))for(let g=0,S=d.length;g<S;g++){const m=d[g],p=a[m.materialIndex],M=Math.max(m.start,f.start),A=Math.min(o.count,Math.min(m.start+m.count,f.start+f.count));for(let b=M,R=A;b<R;b+=3){const E=o.getX(b),_=o.getX(b+1),y=o.getX(b+2);i=os(this,p,e,n,c,h,u,E,_,y),i&&(i.faceIndex=Math.floor(b/3),i.face.materialIndex=m.materialIndex,t.push(i))}}else{const g=Math.max(0,f.start),S=Math.min(o.count,f.start+f.count);for(let m=g,p=S;m<p;m+=3){const M=o.getX(m),A=o.getX(m+1),b=o.getX(m+2);i=os(this,a,e,n,c,h,u,M,A,b),i&&(i.faceIndex=Math.floor(m/3),t.push(i))}}else if(l!==void 0)if(Array.isArray(a))for(let g=0,S=d.length;g<S;g++){const m=d[g],p=a[m.materialIndex],M=Math.max(m.start,f.start),A=Math.min(l.count,Math.min(m.start+m.count,f.start+f.count));for(let b=M,R=A;b<R;b+=3){const E=b,_=b+1,y=b+2;i=os(this,p,e,n,c,h,u,E,_,y),i&&(i.faceIndex=Math.floor(b/3),i.face.materialIndex=m.materialIndex,t.push(i))}}else{const g=Math.max(0,f.start),S=Math.min(l.count,f.start+f.count);for(let m=g,p=S;m<p;m+=3){const M=m,A=m+1,b=m+2;i=os(this,a,e,n,c,h,u,M,A,b),i&&(i.faceIndex=Math.floor(m/3),t.push(i))}}}}function jl(s,e,t,n,i,r,a,o){let l;if(e.side===1?l=n.intersectTriangle(a,r,i,!0,o):l=n.intersectTriangle(i,r,a,e.side===0,o),l===null)return null;as.copy(o),as.applyMatrix4(s.matrixWorld);const c=t.ray.origin.distanceTo(as);return c<t.near||c>t.far?null:{distance:c,point:as.clone(),object:s}}function os(s,e,t,n,i,r,a,o,l,c){s.getVertexPosition(o,ns),s.getVertexPosition(l,is),s.getVertexPosition(c,ss);const h=jl(s,e,t,n,ns,is,ss,Ea);if(h){const u=new D;rn.getBarycoord(Ea,ns,is,ss,u),i&&(h.uv=rn.getInterpolatedAttribute(i,o,l,c,u,new Ye)),r&&(h.uv1=rn.getInterpolatedAttribute(r,o,l,c,u,new Ye)),a&&(h.normal=rn.getInterpolatedAttribute(a,o,l,c,u,new D),h.normal.dot(n.direction)>0&&h.normal.multiplyScalar(-1));const d={a:o,b:l,c,normal:new D,materialIndex:0};rn.getNormal(ns,is,ss,d.normal),h.face=d,h.barycoord=u}return h}class Bi extends Ft{constructor(e=null,t=1,n=1,i,r,a,o,l,c=1003,h=1003,u,d){super(null,a,o,l,c,h,i,r,u,d),this.isDataTexture=!0,this.image={data:e,width:t,height:n},this.generateMipmaps=!1,this.flipY=!1,this.unpackAlignment=1}}class ls extends ct{constructor(e,t,n,i=1){super(e,t,n),this.isInstancedBufferAttribute=!0,this.meshPerAttribute=i}copy(e){return super.copy(e),this.meshPerAttribute=e.meshPerAttribute,this}toJSON(){const e=super.toJSON();return e.meshPerAttribute=this.meshPerAttribute,e.isInstancedBufferAttribute=!0,e}}const Vn=new Qn,ec=new Ye(.5,.5),cs=new D;class Kn{constructor(e=new wn,t=new wn,n=new wn,i=new wn,r=new wn,a=new wn){this.planes=[e,t,n,i,r,a]}set(e,t,n,i,r,a){const o=this.planes;return o[0].copy(e),o[1].copy(t),o[2].copy(n),o[3].copy(i),o[4].copy(r),o[5].copy(a),this}copy(e){const t=this.planes;for(let n=0;n<6;n++)t[n].copy(e.planes[n]);return this}setFromProjectionMatrix(e,t=2e3,n=!1){const i=this.planes,r=e.elements,a=r[0],o=r[1],l=r[2],c=r[3],h=r[4],u=r[5],d=r[6],f=r[7],g=r[8],S=r[9],m=r[10],p=r[11],M=r[12],A=r[13],b=r[14],R=r[15];if(i[0].setComponents(c-a,f-h,p-g,R-M).normalize(),i[1].setComponents(c+a,f+h,p+g,R+M).normalize(),i[2].setComponents(c+o,f+u,p+S,R+A).normalize(),i[3].setComponents(c-o,f-u,p-S,R-A).normalize(),n)i[4].setComponents(l,d,m,b).normalize(),i[5].setComponents(c-l,f-d,p-m,R-b).normalize();else if(i[4].setComponents(c-l,f-d,p-m,R-b).normalize(),t===2e3)i[5].setComponents(c+l,f+d,p+m,R+b).normalize();else if(t===2001)i[5].setComponents(l,d,m,b).normalize();else throw new Error("THREE.Frustum.setFromProjectionMatrix(): Invalid coordinate system: "+t);return this}intersectsObject(e){if(e.boundingSphere!==void 0)e.boundingSphere===null&&e.computeBoundingSphere(),Vn.copy(e.boundingSphere).applyMatrix4(e.matrixWorld);else{const t=e.geometry;t.boundingSphere===null&&t.computeBoundingSphere(),Vn.copy(t.boundingSphere).applyMatrix4(e.matrixWorld)}return this.intersectsSphere(Vn)}intersectsSprite(e){Vn.center.set(0,0,0);const t=ec.distanceTo(e.center);return Vn.radius=.7071067811865476+t,Vn.applyMatrix4(e.matrixWorld),this.intersectsSphere(Vn)}intersectsSphere(e){const t=this.planes,n=e.center,i=-e.radius;for(let r=0;r<6;r++)if(t[r].distanceToPoint(n)<i)return!1;return!0}intersectsBox(e){const t=this.planes;for(let n=0;n<6;n++){const i=t[n];if(cs.x=i.normal.x>0?e.max.x:e.min.x,cs.y=i.normal.y>0?e.max.y:e.min.y,cs.z=i.normal.z>0?e.max.z:e.min.z,i.distanceToPoint(cs)<0)return!1}return!0}containsPoint(e){const t=this.planes;for(let n=0;n<6;n++)if(t[n].distanceToPoint(e)<0)return!1;return!0}clone(){return new this.constructor().copy(this)}}const Ta=new Qe;class Vr{constructor(){this.coordinateSystem=2e3,this._frustums=[],this._count=0}setFromArrayCamera(e){const t=e.cameras,n=this._frustums;for(let i=0;i<t.length;i++){const r=t[i];Ta.multiplyMatrices(r.projectionMatrix,r.matrixWorldInverse),n[i]===void 0&&(n[i]=new Kn),n[i].setFromProjectionMatrix(Ta,r.coordinateSystem,r.reversedDepth)}return this._count=t.length,this}getFrustum(e){return this._frustums[e]}intersectsObject(e){const t=this._frustums;for(let n=0;n<this._count;n++)if(t[n].intersectsObject(e))return!0;return!1}intersectsSprite(e){const t=this._frustums;for(let n=0;n<this._count;n++)if(t[n].intersectsSprite(e))return!0;return!1}intersectsSphere(e){const t=this._frustums;for(let n=0;n<this._count;n++)if(t[n].intersectsSphere(e))return!0;return!1}intersectsBox(e){const t=this._frustums;for(let n=0;n<this._count;n++)if(t[n].intersectsBox(e))return!0;return!1}containsPoint(e){const t=this._frustums;for(let n=0;n<this._count;n++)if(t[n].containsPoint(e))return!0;return!1}copy(e){this.coordinateSystem=e.coordinateSystem;const t=this._frustums,n=e._frustums;for(let i=0;i<e._count;i++)t[i]===void 0&&(t[i]=new Kn),t[i].copy(n[i]);return this._count=e._count,this}clone(){return new Vr().copy(this)}}class Si extends xi{constructor(e){super(),this.isLineBasicMaterial=!0,this.type="LineBasicMaterial",this.color=new Xe(16777215),this.map=null,this.linewidth=1,this.linecap="round",this.linejoin="round",this.fog=!0,this.setValues(e)}copy(e){return super.copy(e),this.color.copy(e.color),this.map=e.map,this.linewidth=e.linewidth,this.linecap=e.linecap,this.linejoin=e.linejoin,this.fog=e.fog,this}}const Fs=new D,Is=new D,Aa=new Qe,Ci=new zs,hs=new Qn,Sr=new D,Ra=new D;class Hs extends It{constructor(e=new ht,t=new Si){super(),this.isLine=!0,this.type="Line",this.geometry=e,this.material=t,this.morphTargetDictionary=void 0,this.morphTargetInfluences=void 0,this.updateMorphTargets()}copy(e,t){return super.copy(e,t),e.morphTargetInfluences!==void 0?this.morphTargetInfluences=e.morphTargetInfluences.slice():this.morphTargetInfluences=void 0,e.morphTargetDictionary!==void 0?this.morphTargetDictionary=Object.assign({},e.morphTargetDictionary):this.morphTargetDictionary=void 0,this.material=Array.isArray(e.material)?e.material.slice():e.material,this.geometry=e.geometry,this}computeLineDistances(){const e=this.geometry;if(e.index===null){const t=e.attributes.position,n=[0];for(let i=1,r=t.count;i<r;i++)Fs.fromBufferAttribute(t,i-1),Is.fromBufferAttribute(t,i),n[i]=n[i-1],n[i]+=Fs.distanceTo(Is);e.setAttribute("lineDistance",new Jt(n,1))}else Le("Line.computeLineDistances(): Computation only possible with non-indexed BufferGeometry.");return this}intersectsFrustum(e){return e.intersectsObject(this)}raycast(e,t){const n=this.geometry,i=this.matrixWorld,r=e.params.Line.threshold,a=n.drawRange;if(n.boundingSphere===null&&n.computeBoundingSphere(),hs.copy(n.boundingSphere),hs.applyMatrix4(i),hs.radius+=r,e.ray.intersectsSphere(hs)===!1)return;Aa.copy(i).invert(),Ci.copy(e.ray).applyMatrix4(Aa);const o=r/((this.scale.x+this.scale.y+this.scale.z)/3),l=o*o,c=this.isLineSegments?2:1,h=n.index,d=n.attributes.position;if(h!==null){const f=Math.max(0,a.start),g=Math.min(h.count,a.start+a.count);for(let S=f,m=g-1;S<m;S+=c){const p=h.getX(S),M=h.getX(S+1),A=ds(this,e,Ci,l,p,M,S);A&&t.push(A)}if(this.isLineLoop){const S=h.getX(g-1),m=h.getX(f),p=ds(this,e,Ci,l,S,m,g-1);p&&t.push(p)}}else{const f=Math.max(0,a.start),g=Math.min(d.count,a.start+a.count);for(let S=f,m=g-1;S<m;S+=c){const p=ds(this,e,Ci,l,S,S+1,S);p&&t.push(p)}if(this.isLineLoop){const S=ds(this,e,Ci,l,g-1,f,g-1);S&&t.push(S)}}}updateMorphTargets(){const t=this.geometry.morphAttributes,n=Object.keys(t);if(n.length>0){const i=t[n[0]];if(i!==void 0){this.morphTargetInfluences=[],this.morphTargetDictionary={};for(let r=0,a=i.length;r<a;r++){const o=i[r].name||String(r);this.morphTargetInfluences.push(0),this.morphTargetDictionary[o]=r}}}}}function ds(s,e,t,n,i,r,a){const o=s.geometry.attributes.position;if(Fs.fromBufferAttribute(o,i),Is.fromBufferAttribute(o,r),t.distanceSqToSegment(Fs,Is,Sr,Ra)>n)return;Sr.applyMatrix4(s.matrixWorld);const c=e.ray.origin.distanceTo(Sr);if(!(c<e.near||c>e.far))return{distance:c,point:Ra.clone().applyMatrix4(s.matrixWorld),index:a,face:null,faceIndex:null,barycoord:null,object:s}}const Ca=new D,Pa=new D;class Vs extends Hs{constructor(e,t){super(e,t),this.isLineSegments=!0,this.type="LineSegments"}computeLineDistances(){const e=this.geometry;if(e.index===null){const t=e.attributes.position,n=[];for(let i=0,r=t.count;i<r;i+=2)Ca.fromBufferAttribute(t,i),Pa.fromBufferAttribute(t,i+1),n[i]=i===0?0:n[i-1],n[i+1]=n[i]+Ca.distanceTo(Pa);e.setAttribute("lineDistance",new Jt(n,1))}else Le("LineSegments.computeLineDistances(): Computation only possible with non-indexed BufferGeometry.");return this}}class Wr extends xi{constructor(e){super(),this.isPointsMaterial=!0,this.type="PointsMaterial",this.color=new Xe(16777215),this.map=null,this.alphaMap=null,this.size=1,this.sizeAttenuation=!0,this.fog=!0,this.setValues(e)}copy(e){return super.copy(e),this.color.copy(e.color),this.map=e.map,this.alphaMap=e.alphaMap,this.size=e.size,this.sizeAttenuation=e.sizeAttenuation,this.fog=e.fog,this}}const La=new Qe,Lr=new zs,us=new Qn,fs=new D;class Hi extends It{constructor(e=new ht,t=new Wr){super(),this.isPoints=!0,this.type="Points",this.geometry=e,this.material=t,this.morphTargetDictionary=void 0,this.morphTargetInfluences=void 0,this.updateMorphTargets()}copy(e,t){return super.copy(e,t),e.morphTargetInfluences!==void 0?this.morphTargetInfluences=e.morphTargetInfluences.slice():this.morphTargetInfluences=void 0,e.morphTargetDictionary!==void 0?this.morphTargetDictionary=Object.assign({},e.morphTargetDictionary):this.morphTargetDictionary=void 0,this.material=Array.isArray(e.material)?e.material.slice():e.material,this.geometry=e.geometry,this}intersectsFrustum(e){return e.intersectsObject(this)}raycast(e,t){const n=this.geometry,i=this.matrixWorld,r=e.params.Points.threshold,a=n.drawRange;if(n.boundingSphere===null&&n.computeBoundingSphere(),us.copy(n.boundingSphere),us.applyMatrix4(i),us.radius+=r,e.ray.intersectsSphere(us)===!1)return;La.copy(i).invert(),Lr.copy(e.ray).applyMatrix4(La);const o=r/((this.scale.x+this.scale.y+this.scale.z)/3),l=o*o,c=n.index,u=n.attributes.position;if(c!==null){const d=Math.max(0,a.start),f=Math.min(c.count,a.start+a.count);for(let g=d,S=f;g<S;g++){const m=c.getX(g);fs.fromBufferAttribute(u,m),Da(fs,m,l,i,e,t,this)}}else{const d=Math.max(0,a.start),f=Math.min(u.count,a.start+a.count);for(let g=d,S=f;g<S;g++)fs.fromBufferAttribute(u,g),Da(fs,g,l,i,e,t,this)}}updateMorphTargets(){const t=this.geometry.morphAttributes,n=Object.keys(t);if(n.length>0){const i=t[n[0]];if(i!==void 0){this.morphTargetInfluences=[],this.morphTargetDictionary={};for(let r=0,a=i.length;r<a;r++){const o=i[r].name||String(r);this.morphTargetInfluences.push(0),this.morphTargetDictionary[o]=r}}}}}function Da(s,e,t,n,i,r,a){const o=Lr.distanceSqToPoint(s);if(o<t){const l=new D;Lr.closestPointToPoint(s,l),l.applyMatrix4(n);const c=i.ray.origin.distanceTo(l);if(c<i.near||c>i.far)return;r.push({distance:c,distanceToRay:Math.sqrt(o),point:l,index:e,face:null,faceIndex:null,barycoord:null,object:a})}}class No extends Ft{constructor(e=[],t=301,n,i,r,a,o,l,c,h){super(e,t,n,i,r,a,o,l,c,h),this.isCubeTexture=!0,this.flipY=!1}get images(){return this.image}set images(e){this.image=e}}class Zn extends Ft{constructor(e,t,n=1014,i,r,a,o=1003,l=1003,c,h=1026,u=1){if(h!==1026&&h!==1027)throw new Error("THREE.DepthTexture: format must be either THREE.DepthFormat or THREE.DepthStencilFormat");const d={width:e,height:t,depth:u};super(d,i,r,a,o,l,h,n,c),this.isDepthTexture=!0,this.flipY=!1,this.generateMipmaps=!1,this.compareFunction=null}copy(e){return super.copy(e),this.source=new zr(Object.assign({},e.image)),this.compareFunction=e.compareFunction,this}toJSON(e){const t=super.toJSON(e);return t.compareFunction=this.compareFunction,t}}class Fo extends Zn{constructor(e,t=1014,n=301,i,r,a=1003,o=1003,l,c=1026){const h={width:e,height:e,depth:1},u=[h,h,h,h,h,h];super(e,e,t,n,i,r,a,o,l,c),this.image=u,this.isCubeDepthTexture=!0,this.isCubeTexture=!0}get images(){return this.image}set images(e){this.image=e}}class Io extends Ft{constructor(e=null){super(),this.sourceTexture=e,this.isExternalTexture=!0}copy(e){return super.copy(e),this.sourceTexture=e.sourceTexture,this}}class Mi extends ht{constructor(e=1,t=1,n=1,i=1,r=1,a=1){super(),this.type="BoxGeometry",this.parameters={width:e,height:t,depth:n,widthSegments:i,heightSegments:r,depthSegments:a};const o=this;i=Math.floor(i),r=Math.floor(r),a=Math.floor(a);const l=[],c=[],h=[],u=[];let d=0,f=0;g("z","y","x",-1,-1,n,t,e,a,r,0),g("z","y","x",1,-1,n,t,-e,a,r,1),g("x","z","y",1,1,e,n,t,i,a,2),g("x","z","y",1,-1,e,n,-t,i,a,3),g("x","y","z",1,-1,e,t,n,i,r,4),g("x","y","z",-1,-1,e,t,-n,i,r,5),this.setIndex(l),this.setAttribute("position",new Jt(c,3)),this.setAttribute("normal",new Jt(h,3)),this.setAttribute("uv",new Jt(u,2));function g(S,m,p,M,A,b,R,E,_,y,k){const N=b/_,I=R/y,z=b/2,$=R/2,P=E/2,W=_+1,Z=y+1;let H=0,te=0;const V=new D;for(let j=0;j<Z;j++){const ee=j*I-$;for(let we=0;we<W;we++){const Pe=we*N-z;V[S]=Pe*M,V[m]=ee*A,V[p]=P,c.push(V.x,V.y,V.z),V[S]=0,V[m]=0,V[p]=E>0?1:-1,h.push(V.x,V.y,V.z),u.push(we/_),u.push(1-j/y),H+=1}}for(let j=0;j<y;j++)for(let ee=0;ee<_;ee++){const we=d+ee+W*j,Pe=d+ee+W*(j+1),q=d+(ee+1)+W*(j+1),he=d+(ee+1)+W*j;l.push(we,Pe,he),l.push(Pe,q,he),te+=6}o.addGroup(f,te,k),f+=te,d+=H}}copy(e){return super.copy(e),this.parameters=Object.assign({},e.parameters),this}static fromJSON(e){return new Mi(e.width,e.height,e.depth,e.widthSegments,e.heightSegments,e.depthSegments)}}class Ws extends ht{constructor(e=1,t=1,n=1,i=1){super(),this.type="PlaneGeometry",this.parameters={width:e,height:t,widthSegments:n,heightSegments:i};const r=e/2,a=t/2,o=Math.floor(n),l=Math.floor(i),c=o+1,h=l+1,u=e/o,d=t/l,f=[],g=[],S=[],m=[];for(let p=0;p<h;p++){const M=p*d-a;for(let A=0;A<c;A++){const b=A*u-r;g.push(b,-M,0),S.push(0,0,1),m.push(A/o),m.push(1-p/l)}}for(let p=0;p<l;p++)for(let M=0;M<o;M++){const A=M+c*p,b=M+c*(p+1),R=M+1+c*(p+1),E=M+1+c*p;f.push(A,b,E),f.push(b,R,E)}this.setIndex(f),this.setAttribute("position",new Jt(g,3)),this.setAttribute("normal",new Jt(S,3)),this.setAttribute("uv",new Jt(m,2))}copy(e){return super.copy(e),this.parameters=Object.assign({},e.parameters),this}static fromJSON(e){return new Ws(e.width,e.height,e.widthSegments,e.heightSegments)}}function mi(s){const e={};for(const t in s){e[t]={};for(const n in s[t]){const i=s[t][n];if(Na(i))i.isRenderTargetTexture?(Le("UniformsUtils: Textures of render targets cannot be cloned via cloneUniforms() or mergeUniforms()."),e[t][n]=null):e[t][n]=i.clone();else if(Array.isArray(i))if(Na(i[0])){const r=[];for(let a=0,o=i.length;a<o;a++)r[a]=i[a].clone();e[t][n]=r}else e[t][n]=i.slice();else e[t][n]=i}}return e}function Nt(s){const e={};for(let t=0;t<s.length;t++){const n=mi(s[t]);for(const i in n)e[i]=n[i]}return e}function Na(s){return s&&(s.isColor||s.isMatrix3||s.isMatrix4||s.isVector2||s.isVector3||s.isVector4||s.isTexture||s.isQuaternion)}function tc(s){const e=[];for(let t=0;t<s.length;t++)e.push(s[t].clone());return e}function Uo(s){const e=s.getRenderTarget();return e===null?s.outputColorSpace:e.isXRRenderTarget===!0?e.texture.colorSpace:qe.workingColorSpace}const nc={clone:mi,merge:Nt};var ic=`void main() {
	gl_Position = projectionMatrix * modelViewMatrix * vec4( position, 1.0 );
}`,sc=`void main() {
	gl_FragColor = vec4( 1.0, 0.0, 0.0, 1.0 );
}`;class pn extends xi{constructor(e){super(),this.isShaderMaterial=!0,this.type="ShaderMaterial",this.defines={},this.uniforms={},this.uniformsGroups=[],this.vertexShader=ic,this.fragmentShader=sc,this.linewidth=1,this.wireframe=!1,this.wireframeLinewidth=1,this.fog=!1,this.lights=!1,this.clipping=!1,this.forceSinglePass=!0,this.extensions={clipCullDistance:!1,multiDraw:!1},this.defaultAttributeValues={color:[1,1,1],uv:[0,0],uv1:[0,0]},this.index0AttributeName=void 0,this.uniformsNeedUpdate=!1,this.glslVersion=null,e!==void 0&&this.setValues(e)}copy(e){return super.copy(e),this.fragmentShader=e.fragmentShader,this.vertexShader=e.vertexShader,this.uniforms=mi(e.uniforms),this.uniformsGroups=tc(e.uniformsGroups),this.defines=Object.assign({},e.defines),this.wireframe=e.wireframe,this.wireframeLinewidth=e.wireframeLinewidth,this.fog=e.fog,this.lights=e.lights,this.clipping=e.clipping,this.extensions=Object.assign({},e.extensions),this.glslVersion=e.glslVersion,this.defaultAttributeValues=Object.assign({},e.defaultAttributeValues),this.index0AttributeName=e.index0AttributeName,this.uniformsNeedUpdate=e.uniformsNeedUpdate,this}toJSON(e){const t=super.toJSON(e);t.glslVersion=this.glslVersion,t.uniforms={};for(const i in this.uniforms){const a=this.uniforms[i].value;a&&a.isTexture?t.uniforms[i]={type:"t",value:a.toJSON(e).uuid}:a&&a.isColor?t.uniforms[i]={type:"c",value:a.getHex()}:a&&a.isVector2?t.uniforms[i]={type:"v2",value:a.toArray()}:a&&a.isVector3?t.uniforms[i]={type:"v3",value:a.toArray()}:a&&a.isVector4?t.uniforms[i]={type:"v4",value:a.toArray()}:a&&a.isMatrix3?t.uniforms[i]={type:"m3",value:a.toArray()}:a&&a.isMatrix4?t.uniforms[i]={type:"m4",value:a.toArray()}:t.uniforms[i]={value:a}}Object.keys(this.defines).length>0&&(t.defines=this.defines),t.vertexShader=this.vertexShader,t.fragmentShader=this.fragmentShader,t.lights=this.lights,t.clipping=this.clipping;const n={};for(const i in this.extensions)this.extensions[i]===!0&&(n[i]=!0);return Object.keys(n).length>0&&(t.extensions=n),t}fromJSON(e,t){if(super.fromJSON(e,t),e.uniforms!==void 0)for(const n in e.uniforms){const i=e.uniforms[n];switch(this.uniforms[n]={},i.type){case"t":this.uniforms[n].value=t[i.value]||null;break;case"c":this.uniforms[n].value=new Xe().setHex(i.value);break;case"v2":this.uniforms[n].value=new Ye().fromArray(i.value);break;case"v3":this.uniforms[n].value=new D().fromArray(i.value);break;case"v4":this.uniforms[n].value=new gt().fromArray(i.value);break;case"m3":this.uniforms[n].value=new Ue().fromArray(i.value);break;case"m4":this.uniforms[n].value=new Qe().fromArray(i.value);break;default:this.uniforms[n].value=i.value}}if(e.defines!==void 0&&(this.defines=e.defines),e.vertexShader!==void 0&&(this.vertexShader=e.vertexShader),e.fragmentShader!==void 0&&(this.fragmentShader=e.fragmentShader),e.glslVersion!==void 0&&(this.glslVersion=e.glslVersion),e.extensions!==void 0)for(const n in e.extensions)this.extensions[n]=e.extensions[n];return e.lights!==void 0&&(this.lights=e.lights),e.clipping!==void 0&&(this.clipping=e.clipping),this}}class rc extends pn{constructor(e){super(e),this.isRawShaderMaterial=!0,this.type="RawShaderMaterial"}}class ac extends xi{constructor(e){super(),this.isMeshDepthMaterial=!0,this.type="MeshDepthMaterial",this.depthPacking=3200,this.map=null,this.alphaMap=null,this.displacementMap=null,this.displacementScale=1,this.displacementBias=0,this.wireframe=!1,this.wireframeLinewidth=1,this.setValues(e)}copy(e){return super.copy(e),this.depthPacking=e.depthPacking,this.map=e.map,this.alphaMap=e.alphaMap,this.displacementMap=e.displacementMap,this.displacementScale=e.displacementScale,this.displacementBias=e.displacementBias,this.wireframe=e.wireframe,this.wireframeLinewidth=e.wireframeLinewidth,this}}class oc extends xi{constructor(e){super(),this.isMeshDistanceMaterial=!0,this.type="MeshDistanceMaterial",this.map=null,this.alphaMap=null,this.displacementMap=null,this.displacementScale=1,this.displacementBias=0,this.setValues(e)}copy(e){return super.copy(e),this.map=e.map,this.alphaMap=e.alphaMap,this.displacementMap=e.displacementMap,this.displacementScale=e.displacementScale,this.displacementBias=e.displacementBias,this}}const ps=new D,ms=new Un,on=new D;class Oo extends It{constructor(){super(),this.isCamera=!0,this.type="Camera",this.matrixWorldInverse=new Qe,this.projectionMatrix=new Qe,this.projectionMatrixInverse=new Qe,this.coordinateSystem=2e3,this._reversedDepth=!1}get reversedDepth(){return this._reversedDepth}copy(e,t){return super.copy(e,t),this.matrixWorldInverse.copy(e.matrixWorldInverse),this.projectionMatrix.copy(e.projectionMatrix),this.projectionMatrixInverse.copy(e.projectionMatrixInverse),this.coordinateSystem=e.coordinateSystem,this}getWorldDirection(e){return super.getWorldDirection(e).negate()}updateMatrixWorld(e){super.updateMatrixWorld(e),this.matrixWorld.decompose(ps,ms,on),on.x===1&&on.y===1&&on.z===1?this.matrixWorldInverse.copy(this.matrixWorld).invert():this.matrixWorldInverse.compose(ps,ms,on.set(1,1,1)).invert()}updateWorldMatrix(e,t,n=!1){super.updateWorldMatrix(e,t,n),this.matrixWorld.decompose(ps,ms,on),on.x===1&&on.y===1&&on.z===1?this.matrixWorldInverse.copy(this.matrixWorld).invert():this.matrixWorldInverse.compose(ps,ms,on.set(1,1,1)).invert()}clone(){return new this.constructor().copy(this)}}const Nn=new D,Fa=new Ye,Ia=new Ye;class sn extends Oo{constructor(e=50,t=1,n=.1,i=2e3){super(),this.isPerspectiveCamera=!0,this.type="PerspectiveCamera",this.fov=e,this.zoom=1,this.near=n,this.far=i,this.focus=10,this.aspect=t,this.view=null,this.filmGauge=35,this.filmOffset=0,this.updateProjectionMatrix()}copy(e,t){return super.copy(e,t),this.fov=e.fov,this.zoom=e.zoom,this.near=e.near,this.far=e.far,this.focus=e.focus,this.aspect=e.aspect,this.view=e.view===null?null:Object.assign({},e.view),this.filmGauge=e.filmGauge,this.filmOffset=e.filmOffset,this}setFocalLength(e){const t=.5*this.getFilmHeight()/e;this.fov=Pr*2*Math.atan(t),this.updateProjectionMatrix()}getFocalLength(){const e=Math.tan(Qs*.5*this.fov);return .5*this.getFilmHeight()/e}getEffectiveFOV(){return Pr*2*Math.atan(Math.tan(Qs*.5*this.fov)/this.zoom)}getFilmWidth(){return this.filmGauge*Math.min(this.aspect,1)}getFilmHeight(){return this.filmGauge/Math.max(this.aspect,1)}getViewBounds(e,t,n){Nn.set(-1,-1,.5).applyMatrix4(this.projectionMatrixInverse),t.set(Nn.x,Nn.y).multiplyScalar(-e/Nn.z),Nn.set(1,1,.5).applyMatrix4(this.projectionMatrixInverse),n.set(Nn.x,Nn.y).multiplyScalar(-e/Nn.z)}getViewSize(e,t){return this.getViewBounds(e,Fa,Ia),t.subVectors(Ia,Fa)}setViewOffset(e,t,n,i,r,a){this.aspect=e/t,this.view===null&&(this.view={enabled:!0,fullWidth:1,fullHeight:1,offsetX:0,offsetY:0,width:1,height:1}),this.view.enabled=!0,this.view.fullWidth=e,this.view.fullHeight=t,this.view.offsetX=n,this.view.offsetY=i,this.view.width=r,this.view.height=a,this.updateProjectionMatrix()}clearViewOffset(){this.view!==null&&(this.view.enabled=!1),this.updateProjectionMatrix()}updateProjectionMatrix(){const e=this.near;let t=e*Math.tan(Qs*.5*this.fov)/this.zoom,n=2*t,i=this.aspect*n,r=-.5*i;const a=this.view;if(this.view!==null&&this.view.enabled){const l=a.fullWidth,c=a.fullHeight;r+=a.offsetX*i/l,t-=a.offsetY*n/c,i*=a.width/l,n*=a.height/c}const o=this.filmOffset;o!==0&&(r+=e*o/this.getFilmWidth()),this.projectionMatrix.makePerspective(r,r+i,t,t-n,e,this.far,this.coordinateSystem,this.reversedDepth),this.projectionMatrixInverse.copy(this.projectionMatrix).invert()}toJSON(e){const t=super.toJSON(e);return t.object.fov=this.fov,t.object.zoom=this.zoom,t.object.near=this.near,t.object.far=this.far,t.object.focus=this.focus,t.object.aspect=this.aspect,this.view!==null&&(t.object.view=Object.assign({},this.view)),t.object.filmGauge=this.filmGauge,t.object.filmOffset=this.filmOffset,t}}class Bo extends Oo{constructor(e=-1,t=1,n=1,i=-1,r=.1,a=2e3){super(),this.isOrthographicCamera=!0,this.type="OrthographicCamera",this.zoom=1,this.view=null,this.left=e,this.right=t,this.top=n,this.bottom=i,this.near=r,this.far=a,this.updateProjectionMatrix()}copy(e,t){return super.copy(e,t),this.left=e.left,this.right=e.right,this.top=e.top,this.bottom=e.bottom,this.near=e.near,this.far=e.far,this.zoom=e.zoom,this.view=e.view===null?null:Object.assign({},e.view),this}setViewOffset(e,t,n,i,r,a){this.view===null&&(this.view={enabled:!0,fullWidth:1,fullHeight:1,offsetX:0,offsetY:0,width:1,height:1}),this.view.enabled=!0,this.view.fullWidth=e,this.view.fullHeight=t,this.view.offsetX=n,this.view.offsetY=i,this.view.width=r,this.view.height=a,this.updateProjectionMatrix()}clearViewOffset(){this.view!==null&&(this.view.enabled=!1),this.updateProjectionMatrix()}updateProjectionMatrix(){const e=(this.right-this.left)/(2*this.zoom),t=(this.top-this.bottom)/(2*this.zoom),n=(this.right+this.left)/2,i=(this.top+this.bottom)/2;let r=n-e,a=n+e,o=i+t,l=i-t;if(this.view!==null&&this.view.enabled){const c=(this.right-this.left)/this.view.fullWidth/this.zoom,h=(this.top-this.bottom)/this.view.fullHeight/this.zoom;r+=c*this.view.offsetX,a=r+c*this.view.width,o-=h*this.view.offsetY,l=o-h*this.view.height}this.projectionMatrix.makeOrthographic(r,a,o,l,this.near,this.far,this.coordinateSystem,this.reversedDepth),this.projectionMatrixInverse.copy(this.projectionMatrix).invert()}toJSON(e){const t=super.toJSON(e);return t.object.zoom=this.zoom,t.object.left=this.left,t.object.right=this.right,t.object.top=this.top,t.object.bottom=this.bottom,t.object.near=this.near,t.object.far=this.far,this.view!==null&&(t.object.view=Object.assign({},this.view)),t}}class lc extends ht{constructor(){super(),this.isInstancedBufferGeometry=!0,this.type="InstancedBufferGeometry",this.instanceCount=1/0}copy(e){return super.copy(e),this.instanceCount=e.instanceCount,this}toJSON(){const e=super.toJSON();return e.instanceCount=this.instanceCount,e.isInstancedBufferGeometry=!0,e}}const ci=-90,hi=1;class Dr extends It{constructor(e,t,n){super(),this.type="CubeCamera",this.renderTarget=n,this.coordinateSystem=null,this.activeMipmapLevel=0;const i=new sn(ci,hi,e,t);i.layers=this.layers,this.add(i);const r=new sn(ci,hi,e,t);r.layers=this.layers,this.add(r);const a=new sn(ci,hi,e,t);a.layers=this.layers,this.add(a);const o=new sn(ci,hi,e,t);o.layers=this.layers,this.add(o);const l=new sn(ci,hi,e,t);l.layers=this.layers,this.add(l);const c=new sn(ci,hi,e,t);c.layers=this.layers,this.add(c)}updateCoordinateSystem(){const e=this.coordinateSystem,t=this.children.concat(),[n,i,r,a,o,l]=t;for(const c of t)this.remove(c);if(e===2e3)n.up.set(0,1,0),n.lookAt(1,0,0),i.up.set(0,1,0),i.lookAt(-1,0,0),r.up.set(0,0,-1),r.lookAt(0,1,0),a.up.set(0,0,1),a.lookAt(0,-1,0),o.up.set(0,1,0),o.lookAt(0,0,1),l.up.set(0,1,0),l.lookAt(0,0,-1);else if(e===2001)n.up.set(0,-1,0),n.lookAt(-1,0,0),i.up.set(0,-1,0),i.lookAt(1,0,0),r.up.set(0,0,1),r.lookAt(0,1,0),a.up.set(0,0,-1),a.lookAt(0,-1,0),o.up.set(0,-1,0),o.lookAt(0,0,1),l.up.set(0,-1,0),l.lookAt(0,0,-1);else throw new Error("THREE.CubeCamera.updateCoordinateSystem(): Invalid coordinate system: "+e);for(const c of t)this.add(c),c.updateMatrixWorld()}update(e,t){this.parent===null&&this.updateMatrixWorld();const{renderTarget:n,activeMipmapLevel:i}=this;this.coordinateSystem!==e.coordinateSystem&&(this.coordinateSystem=e.coordinateSystem,this.updateCoordinateSystem());const[r,a,o,l,c,h]=this.children,u=e.getRenderTarget(),d=e.getActiveCubeFace(),f=e.getActiveMipmapLevel(),g=e.xr.enabled;e.xr.enabled=!1;const S=n.texture.mipmapsAutoUpdate;n.texture.mipmapsAutoUpdate=!1;let m=!1;e.isWebGLRenderer===!0?m=e.state.buffers.depth.getReversed():m=e.reversedDepthBuffer,e.setRenderTarget(n,0,i),m&&e.autoClear===!1&&e.clearDepth(),e.render(t,r),e.setRenderTarget(n,1,i),m&&e.autoClear===!1&&e.clearDepth(),e.render(t,a),e.setRenderTarget(n,2,i),m&&e.autoClear===!1&&e.clearDepth(),e.render(t,o),e.setRenderTarget(n,3,i),m&&e.autoClear===!1&&e.clearDepth(),e.render(t,l),e.setRenderTarget(n,4,i),m&&e.autoClear===!1&&e.clearDepth(),e.render(t,c),n.texture.mipmapsAutoUpdate=S,e.setRenderTarget(n,5,i),m&&e.autoClear===!1&&e.clearDepth(),e.render(t,h),e.setRenderTarget(u,d,f),e.xr.enabled=g,n.texture.needsPMREMUpdate=!0}}class cc extends sn{constructor(e=[]){super(),this.isArrayCamera=!0,this.isMultiViewCamera=!1,this.cameras=e,this.perCameraFrustumCulled=!1}}const Ua=new Qe;class ko{constructor(e,t,n=0,i=1/0){this.ray=new zs(e,t),this.near=n,this.far=i,this.camera=null,this.layers=new Hr,this.params={Mesh:{},Line:{threshold:1},LOD:{},Points:{threshold:1},Sprite:{}}}set(e,t){this.ray.set(e,t)}setFromCamera(e,t){t.isPerspectiveCamera?(this.ray.origin.setFromMatrixPosition(t.matrixWorld),this.ray.direction.set(e.x,e.y,.5).unproject(t).sub(this.ray.origin).normalize(),this.camera=t):t.isOrthographicCamera?(this.ray.origin.set(e.x,e.y,t.projectionMatrix.elements[14]).unproject(t),this.ray.direction.set(0,0,-1).transformDirection(t.matrixWorld),this.camera=t):Je("Raycaster: Unsupported camera type: "+t.type)}setFromXRController(e){return Ua.identity().extractRotation(e.matrixWorld),this.ray.origin.setFromMatrixPosition(e.matrixWorld),this.ray.direction.set(0,0,-1).applyMatrix4(Ua),this}intersectObject(e,t=!0,n=[]){return Nr(e,this,n,t),n.sort(Oa),n}intersectObjects(e,t=!0,n=[]){for(let i=0,r=e.length;i<r;i++)Nr(e[i],this,n,t);return n.sort(Oa),n}}function Oa(s,e){return s.distance-e.distance}function Nr(s,e,t,n){let i=!0;if(s.layers.test(e.layers)&&s.raycast(e,t)===!1&&(i=!1),i===!0&&n===!0){const r=s.children;for(let a=0,o=r.length;a<o;a++)Nr(r[a],e,t,!0)}}class hc{constructor(e=1,t=0,n=0){this.radius=e,this.phi=t,this.theta=n}set(e,t,n){return this.radius=e,this.phi=t,this.theta=n,this}copy(e){return this.radius=e.radius,this.phi=e.phi,this.theta=e.theta,this}makeSafe(){return this.phi=ze(this.phi,1e-6,Math.PI-1e-6),this}setFromVector3(e){return this.setFromCartesianCoords(e.x,e.y,e.z)}setFromCartesianCoords(e,t,n){return this.radius=Math.sqrt(e*e+t*t+n*n),this.radius===0?(this.theta=0,this.phi=0):(this.theta=Math.atan2(e,n),this.phi=Math.acos(ze(t/this.radius,-1,1))),this}clone(){return new this.constructor().copy(this)}}class Go extends Vs{constructor(e,t=16776960){const n=new Uint16Array([0,1,1,2,2,3,3,0,4,5,5,6,6,7,7,4,0,4,1,5,2,6,3,7]),i=[1,1,1,-1,1,1,-1,-1,1,1,-1,1,1,1,-1,-1,1,-1,-1,-1,-1,1,-1,-1],r=new ht;r.setIndex(new ct(n,1)),r.setAttribute("position",new Jt(i,3)),super(r,new Si({color:t,toneMapped:!1})),this.box=e,this.type="Box3Helper",this.geometry.computeBoundingSphere()}updateMatrixWorld(e){const t=this.box;t.isEmpty()||(t.getCenter(this.position),t.getSize(this.scale),this.scale.multiplyScalar(.5),super.updateMatrixWorld(e))}dispose(){super.dispose(),this.geometry.dispose(),this.material.dispose()}}function Ba(s,e,t,n){const i=dc(n);switch(t){case 1021:return s*e;case 1028:return s*e/i.components*i.byteLength;case 1029:return s*e/i.components*i.byteLength;case 1030:return s*e*2/i.components*i.byteLength;case 1031:return s*e*2/i.components*i.byteLength;case 1022:return s*e*3/i.components*i.byteLength;case 1023:return s*e*4/i.components*i.byteLength;case 1033:return s*e*4/i.components*i.byteLength;case 33776:case 33777:return Math.floor((s+3)/4)*Math.floor((e+3)/4)*8;case 33778:case 33779:return Math.floor((s+3)/4)*Math.floor((e+3)/4)*16;case 35841:case 35843:return Math.max(s,16)*Math.max(e,8)/4;case 35840:case 35842:return Math.max(s,8)*Math.max(e,8)/2;case 36196:case 37492:case 37488:case 37489:return Math.floor((s+3)/4)*Math.floor((e+3)/4)*8;case 37496:case 37490:case 37491:return Math.floor((s+3)/4)*Math.floor((e+3)/4)*16;case 37808:return Math.floor((s+3)/4)*Math.floor((e+3)/4)*16;case 37809:return Math.floor((s+4)/5)*Math.floor((e+3)/4)*16;case 37810:return Math.floor((s+4)/5)*Math.floor((e+4)/5)*16;case 37811:return Math.floor((s+5)/6)*Math.floor((e+4)/5)*16;case 37812:return Math.floor((s+5)/6)*Math.floor((e+5)/6)*16;case 37813:return Math.floor((s+7)/8)*Math.floor((e+4)/5)*16;case 37814:return Math.floor((s+7)/8)*Math.floor((e+5)/6)*16;case 37815:return Math.floor((s+7)/8)*Math.floor((e+7)/8)*16;case 37816:return Math.floor((s+9)/10)*Math.floor((e+4)/5)*16;case 37817:return Math.floor((s+9)/10)*Math.floor((e+5)/6)*16;case 37818:return Math.floor((s+9)/10)*Math.floor((e+7)/8)*16;case 37819:return Math.floor((s+9)/10)*Math.floor((e+9)/10)*16;case 37820:return Math.floor((s+11)/12)*Math.floor((e+9)/10)*16;case 37821:return Math.floor((s+11)/12)*Math.floor((e+11)/12)*16;case 36492:case 36494:case 36495:return Math.ceil(s/4)*Math.ceil(e/4)*16;case 36283:case 36284:return Math.ceil(s/4)*Math.ceil(e/4)*8;case 36285:case 36286:return Math.ceil(s/4)*Math.ceil(e/4)*16}throw new Error(`Unable to determine texture byte length for ${t} format.`)}function dc(s){switch(s){case 1009:case 1010:return{byteLength:1,components:1};case 1012:case 1011:case 1016:return{byteLength:2,components:1};case 1017:case 1018:return{byteLength:2,components:4};case 1014:case 1013:case 1015:return{byteLength:4,components:1};case 35902:case 35899:return{byteLength:4,components:3}}throw new Error(`THREE.TextureUtils: Unknown texture type ${s}.`)}typeof __THREE_DEVTOOLS__<"u"&&__THREE_DEVTOOLS__.dispatchEvent(new CustomEvent("register",{detail:{revision:"187"}}));typeof window<"u"&&(window.__THREE__?Le("WARNING: Multiple instances of Three.js being imported."):window.__THREE__="187");/**
 * @license
 * Copyright 2010-2026 Three.js Authors
 * SPDX-License-Identifier: MIT
 */function zo(){let s=null,e=!1,t=null,n=null;function i(r,a){n=s.requestAnimationFrame(i),t(r,a)}return{start:function(){e!==!0&&t!==null&&s!==null&&(n=s.requestAnimationFrame(i),e=!0)},stop:function(){s!==null&&s.cancelAnimationFrame(n),e=!1},setAnimationLoop:function(r){t=r},setContext:function(r){s=r}}}function uc(s){const e=new WeakMap;function t(o,l){const c=o.array,h=o.usage,u=c.byteLength,d=s.createBuffer();s.bindBuffer(l,d),s.bufferData(l,c,h),o.onUploadCallback();let f;if(c instanceof Float32Array)f=s.FLOAT;else if(typeof Float16Array<"u"&&c instanceof Float16Array)f=s.HALF_FLOAT;else if(c instanceof Uint16Array)o.isFloat16BufferAttribute?f=s.HALF_FLOAT:f=s.UNSIGNED_SHORT;else if(c instanceof Int16Array)f=s.SHORT;else if(c instanceof Uint32Array)f=s.UNSIGNED_INT;else if(c instanceof Int32Array)f=s.INT;else if(c instanceof Int8Array)f=s.BYTE;else if(c instanceof Uint8Array)f=s.UNSIGNED_BYTE;else if(c instanceof Uint8ClampedArray)f=s.UNSIGNED_BYTE;else throw new Error("THREE.WebGLAttributes: Unsupported buffer data format: "+c);return{buffer:d,type:f,bytesPerElement:c.BYTES_PER_ELEMENT,version:o.version,size:u}}function n(o,l,c){const h=l.array,u=l.updateRanges;if(s.bindBuffer(c,o),u.length===0)s.bufferSubData(c,0,h);else{u.sort((f,g)=>f.start-g.start);let d=0;for(let f=1;f<u.length;f++){const g=u[d],S=u[f];S.start<=g.start+g.count+1?g.count=Math.max(g.count,S.start+S.count-g.start):(++d,u[d]=S)}u.length=d+1;for(let f=0,g=u.length;f<g;f++){const S=u[f];s.bufferSubData(c,S.start*h.BYTES_PER_ELEMENT,h,S.start,S.count)}l.clearUpdateRanges()}l.onUploadCallback()}function i(o){return o.isInterleavedBufferAttribute&&(o=o.data),e.get(o)}function r(o){o.isInterleavedBufferAttribute&&(o=o.data);const l=e.get(o);l&&(s.deleteBuffer(l.buffer),e.delete(o))}function a(o,l){if(o.isInterleavedBufferAttribute&&(o=o.data),o.isGLBufferAttribute){const h=e.get(o);(!h||h.version<o.version)&&e.set(o,{buffer:o.buffer,type:o.type,bytesPerElement:o.elementSize,version:o.version});return}const c=e.get(o);if(c===void 0)e.set(o,t(o,l));else if(c.version<o.version){if(c.size!==o.array.byteLength)throw new Error("THREE.WebGLAttributes: The size of the buffer attribute's array buffer does not match the original size. Resizing buffer attributes is not supported.");n(c.buffer,o,l),c.version=o.version}}return{get:i,remove:r,update:a}}var fc=`#ifdef USE_ALPHAHASH
	if ( diffuseColor.a < getAlphaHashThreshold( vPosition ) ) discard;
#endif`,pc=`#ifdef USE_ALPHAHASH
	const float ALPHA_HASH_SCALE = 0.05;
	float hash2D( vec2 value ) {
		return fract( 1.0e4 * sin( 17.0 * value.x + 0.1 * value.y ) * ( 0.1 + abs( sin( 13.0 * value.y + value.x ) ) ) );
	}
	float hash3D( vec3 value ) {
		return hash2D( vec2( hash2D( value.xy ), value.z ) );
	}
	float getAlphaHashThreshold( vec3 position ) {
		float maxDeriv = max(
			length( dFdx( position.xyz ) ),
			length( dFdy( position.xyz ) )
		);
		float pixScale = 1.0 / ( ALPHA_HASH_SCALE * maxDeriv );
		vec2 pixScales = vec2(
			exp2( floor( log2( pixScale ) ) ),
			exp2( ceil( log2( pixScale ) ) )
		);
		vec2 alpha = vec2(
			hash3D( floor( pixScales.x * position.xyz ) ),
			hash3D( floor( pixScales.y * position.xyz ) )
		);
		float lerpFactor = fract( log2( pixScale ) );
		float x = ( 1.0 - lerpFactor ) * alpha.x + lerpFactor * alpha.y;
		float a = min( lerpFactor, 1.0 - lerpFactor );
		vec3 cases = vec3(
			x * x / ( 2.0 * a * ( 1.0 - a ) ),
			( x - 0.5 * a ) / ( 1.0 - a ),
			1.0 - ( ( 1.0 - x ) * ( 1.0 - x ) / ( 2.0 * a * ( 1.0 - a ) ) )
		);
		float threshold = ( x < ( 1.0 - a ) )
			? ( ( x < a ) ? cases.x : cases.y )
			: cases.z;
		return clamp( threshold , 1.0e-6, 1.0 );
	}
#endif`,mc=`#ifdef USE_ALPHAMAP
	diffuseColor.a *= texture2D( alphaMap, vAlphaMapUv ).g;
#endif`,gc=`#ifdef USE_ALPHAMAP
	uniform sampler2D alphaMap;
#endif`,_c=`#ifdef USE_ALPHATEST
	#ifdef ALPHA_TO_COVERAGE
	diffuseColor.a = smoothstep( alphaTest, alphaTest + fwidth( diffuseColor.a ), diffuseColor.a );
	if ( diffuseColor.a == 0.0 ) discard;
	#else
	if ( diffuseColor.a < alphaTest ) discard;
	#endif
#endif`,vc=`#ifdef USE_ALPHATEST
	uniform float alphaTest;
#endif`,xc=`#ifdef USE_AOMAP
	float ambientOcclusion = ( texture2D( aoMap, vAoMapUv ).r - 1.0 ) * aoMapIntensity + 1.0;
	reflectedLight.indirectDiffuse *= ambientOcclusion;
	#if defined( USE_CLEARCOAT ) 
		clearcoatSpecularIndirect *= ambientOcclusion;
	#endif
	#if defined( USE_SHEEN ) 
		sheenSpecularIndirect *= ambientOcclusion;
	#endif
	#if defined( USE_ENVMAP ) && defined( STANDARD )
		float dotNV = saturate( dot( geometryNormal, geometryViewDir ) );
		reflectedLight.indirectSpecular *= computeSpecularOcclusion( dotNV, ambientOcclusion, material.roughness );
	#endif
#endif`,Sc=`#ifdef USE_AOMAP
	uniform sampler2D aoMap;
	uniform float aoMapIntensity;
#endif`,Mc=`#ifdef USE_BATCHING
	#if ! defined( GL_ANGLE_multi_draw )
	#define gl_DrawID _gl_DrawID
	uniform int _gl_DrawID;
	#endif
	uniform highp sampler2D batchingTexture;
	uniform highp usampler2D batchingIdTexture;
	mat4 getBatchingMatrix( const in float i ) {
		int size = textureSize( batchingTexture, 0 ).x;
		int j = int( i ) * 4;
		int x = j % size;
		int y = j / size;
		vec4 v1 = texelFetch( batchingTexture, ivec2( x, y ), 0 );
		vec4 v2 = texelFetch( batchingTexture, ivec2( x + 1, y ), 0 );
		vec4 v3 = texelFetch( batchingTexture, ivec2( x + 2, y ), 0 );
		vec4 v4 = texelFetch( batchingTexture, ivec2( x + 3, y ), 0 );
		return mat4( v1, v2, v3, v4 );
	}
	float getIndirectIndex( const in int i ) {
		int size = textureSize( batchingIdTexture, 0 ).x;
		int x = i % size;
		int y = i / size;
		return float( texelFetch( batchingIdTexture, ivec2( x, y ), 0 ).r );
	}
#endif
#ifdef USE_BATCHING_COLOR
	uniform sampler2D batchingColorTexture;
	vec4 getBatchingColor( const in float i ) {
		int size = textureSize( batchingColorTexture, 0 ).x;
		int j = int( i );
		int x = j % size;
		int y = j / size;
		return texelFetch( batchingColorTexture, ivec2( x, y ), 0 );
	}
#endif`,wc=`#ifdef USE_BATCHING
	mat4 batchingMatrix = getBatchingMatrix( getIndirectIndex( gl_DrawID ) );
#endif`,yc=`vec3 transformed = vec3( position );
#ifdef USE_ALPHAHASH
	vPosition = vec3( position );
#endif`,bc=`vec3 objectNormal = vec3( normal );
#ifdef USE_TANGENT
	vec3 objectTangent = vec3( tangent.xyz );
#endif`,Ec=`float G_BlinnPhong_Implicit( ) {
	return 0.25;
}
float D_BlinnPhong( const in float shininess, const in float dotNH ) {
	return RECIPROCAL_PI * ( shininess * 0.5 + 1.0 ) * pow( dotNH, shininess );
}
vec3 BRDF_BlinnPhong( const in vec3 lightDir, const in vec3 viewDir, const in vec3 normal, const in vec3 specularColor, const in float shininess ) {
	vec3 halfDir = normalize( lightDir + viewDir );
	float dotNH = saturate( dot( normal, halfDir ) );
	float dotVH = saturate( dot( viewDir, halfDir ) );
	vec3 F = F_Schlick( specularColor, 1.0, dotVH );
	float G = G_BlinnPhong_Implicit( );
	float D = D_BlinnPhong( shininess, dotNH );
	return F * ( G * D );
} // validated`,Tc=`#ifdef USE_IRIDESCENCE
	const mat3 XYZ_TO_REC709 = mat3(
		 3.2404542, -0.9692660,  0.0556434,
		-1.5371385,  1.8760108, -0.2040259,
		-0.4985314,  0.0415560,  1.0572252
	);
	vec3 Fresnel0ToIor( vec3 fresnel0 ) {
		vec3 sqrtF0 = sqrt( fresnel0 );
		return ( vec3( 1.0 ) + sqrtF0 ) / ( vec3( 1.0 ) - sqrtF0 );
	}
	vec3 IorToFresnel0( vec3 transmittedIor, float incidentIor ) {
		return pow2( ( transmittedIor - vec3( incidentIor ) ) / ( transmittedIor + vec3( incidentIor ) ) );
	}
	float IorToFresnel0( float transmittedIor, float incidentIor ) {
		return pow2( ( transmittedIor - incidentIor ) / ( transmittedIor + incidentIor ));
	}
	vec3 evalSensitivity( float OPD, vec3 shift ) {
		float phase = 2.0 * PI * OPD * 1.0e-9;
		vec3 val = vec3( 5.4856e-13, 4.4201e-13, 5.2481e-13 );
		vec3 pos = vec3( 1.6810e+06, 1.7953e+06, 2.2084e+06 );
		vec3 var = vec3( 4.3278e+09, 9.3046e+09, 6.6121e+09 );
		vec3 xyz = val * sqrt( 2.0 * PI * var ) * cos( pos * phase + shift ) * exp( - pow2( phase ) * var );
		xyz.x += 9.7470e-14 * sqrt( 2.0 * PI * 4.5282e+09 ) * cos( 2.2399e+06 * phase + shift[ 0 ] ) * exp( - 4.5282e+09 * pow2( phase ) );
		xyz /= 1.0685e-7;
		vec3 rgb = XYZ_TO_REC709 * xyz;
		return rgb;
	}
	vec3 evalIridescence( float outsideIOR, float eta2, float cosTheta1, float thinFilmThickness, vec3 baseF0 ) {
		vec3 I;
		float iridescenceIOR = mix( outsideIOR, eta2, smoothstep( 0.0, 0.03, thinFilmThickness ) );
		float sinTheta2Sq = pow2( outsideIOR / iridescenceIOR ) * ( 1.0 - pow2( cosTheta1 ) );
		float cosTheta2Sq = 1.0 - sinTheta2Sq;
		if ( cosTheta2Sq < 0.0 ) {
			return vec3( 1.0 );
		}
		float cosTheta2 = sqrt( cosTheta2Sq );
		float R0 = IorToFresnel0( iridescenceIOR, outsideIOR );
		float R12 = F_Schlick( R0, 1.0, cosTheta1 );
		float T121 = 1.0 - R12;
		float phi12 = 0.0;
		if ( iridescenceIOR < outsideIOR ) phi12 = PI;
		float phi21 = PI - phi12;
		vec3 baseIOR = Fresnel0ToIor( clamp( baseF0, 0.0, 0.9999 ) );		vec3 R1 = IorToFresnel0( baseIOR, iridescenceIOR );
		vec3 R23 = F_Schlick( R1, 1.0, cosTheta2 );
		vec3 phi23 = vec3( 0.0 );
		if ( baseIOR[ 0 ] < iridescenceIOR ) phi23[ 0 ] = PI;
		if ( baseIOR[ 1 ] < iridescenceIOR ) phi23[ 1 ] = PI;
		if ( baseIOR[ 2 ] < iridescenceIOR ) phi23[ 2 ] = PI;
		float OPD = 2.0 * iridescenceIOR * thinFilmThickness * cosTheta2;
		vec3 phi = vec3( phi21 ) + phi23;
		vec3 R123 = clamp( R12 * R23, 1e-5, 0.9999 );
		vec3 r123 = sqrt( R123 );
		vec3 Rs = pow2( T121 ) * R23 / ( vec3( 1.0 ) - R123 );
		vec3 C0 = R12 + Rs;
		I = C0;
		vec3 Cm = Rs - T121;
		for ( int m = 1; m <= 2; ++ m ) {
			Cm *= r123;
			vec3 Sm = 2.0 * evalSensitivity( float( m ) * OPD, float( m ) * phi );
			I += Cm * Sm;
		}
		return max( I, vec3( 0.0 ) );
	}
#endif`,Ac=`#ifdef USE_BUMPMAP
	uniform sampler2D bumpMap;
	uniform float bumpScale;
	vec2 dHdxy_fwd() {
		vec2 dSTdx = dFdx( vBumpMapUv );
		vec2 dSTdy = dFdy( vBumpMapUv );
		float Hll = bumpScale * texture2D( bumpMap, vBumpMapUv ).x;
		float dBx = bumpScale * texture2D( bumpMap, vBumpMapUv + dSTdx ).x - Hll;
		float dBy = bumpScale * texture2D( bumpMap, vBumpMapUv + dSTdy ).x - Hll;
		return vec2( dBx, dBy );
	}
	vec3 perturbNormalArb( vec3 surf_pos, vec3 surf_norm, vec2 dHdxy, float faceDirection ) {
		vec3 vSigmaX = normalize( dFdx( surf_pos.xyz ) );
		vec3 vSigmaY = normalize( dFdy( surf_pos.xyz ) );
		vec3 vN = surf_norm;
		vec3 R1 = cross( vSigmaY, vN );
		vec3 R2 = cross( vN, vSigmaX );
		float fDet = dot( vSigmaX, R1 ) * faceDirection;
		vec3 vGrad = sign( fDet ) * ( dHdxy.x * R1 + dHdxy.y * R2 );
		return normalize( abs( fDet ) * surf_norm - vGrad );
	}
#endif`,Rc=`#if NUM_CLIPPING_PLANES > 0
	vec4 plane;
	#ifdef ALPHA_TO_COVERAGE
		float distanceToPlane, distanceGradient;
		float clipOpacity = 1.0;
		#pragma unroll_loop_start
		for ( int i = 0; i < UNION_CLIPPING_PLANES; i ++ ) {
			plane = clippingPlanes[ i ];
			distanceToPlane = - dot( vClipPosition, plane.xyz ) + plane.w;
			distanceGradient = fwidth( distanceToPlane ) / 2.0;
			clipOpacity *= smoothstep( - distanceGradient, distanceGradient, distanceToPlane );
			if ( clipOpacity == 0.0 ) discard;
		}
		#pragma unroll_loop_end
		#if UNION_CLIPPING_PLANES < NUM_CLIPPING_PLANES
			float unionClipOpacity = 1.0;
			#pragma unroll_loop_start
			for ( int i = UNION_CLIPPING_PLANES; i < NUM_CLIPPING_PLANES; i ++ ) {
				plane = clippingPlanes[ i ];
				distanceToPlane = - dot( vClipPosition, plane.xyz ) + plane.w;
				distanceGradient = fwidth( distanceToPlane ) / 2.0;
				unionClipOpacity *= 1.0 - smoothstep( - distanceGradient, distanceGradient, distanceToPlane );
			}
			#pragma unroll_loop_end
			clipOpacity *= 1.0 - unionClipOpacity;
		#endif
		diffuseColor.a *= clipOpacity;
		if ( diffuseColor.a == 0.0 ) discard;
	#else
		#pragma unroll_loop_start
		for ( int i = 0; i < UNION_CLIPPING_PLANES; i ++ ) {
			plane = clippingPlanes[ i ];
			if ( dot( vClipPosition, plane.xyz ) > plane.w ) discard;
		}
		#pragma unroll_loop_end
		#if UNION_CLIPPING_PLANES < NUM_CLIPPING_PLANES
			bool clipped = true;
			#pragma unroll_loop_start
			for ( int i = UNION_CLIPPING_PLANES; i < NUM_CLIPPING_PLANES; i ++ ) {
				plane = clippingPlanes[ i ];
				clipped = ( dot( vClipPosition, plane.xyz ) > plane.w ) && clipped;
			}
			#pragma unroll_loop_end
			if ( clipped ) discard;
		#endif
	#endif
#endif`,Cc=`#if NUM_CLIPPING_PLANES > 0
	varying vec3 vClipPosition;
	uniform vec4 clippingPlanes[ NUM_CLIPPING_PLANES ];
#endif`,Pc=`#if NUM_CLIPPING_PLANES > 0
	varying vec3 vClipPosition;
#endif`,Lc=`#if NUM_CLIPPING_PLANES > 0
	vClipPosition = - mvPosition.xyz;
#endif`,Dc=`#if defined( USE_COLOR ) || defined( USE_COLOR_ALPHA )
	diffuseColor *= vColor;
#endif`,Nc=`#if defined( USE_COLOR ) || defined( USE_COLOR_ALPHA )
	varying vec4 vColor;
#endif`,Fc=`#if defined( USE_COLOR ) || defined( USE_COLOR_ALPHA ) || defined( USE_INSTANCING_COLOR ) || defined( USE_BATCHING_COLOR )
	varying vec4 vColor;
#endif`,Ic=`#if defined( USE_COLOR ) || defined( USE_COLOR_ALPHA ) || defined( USE_INSTANCING_COLOR ) || defined( USE_BATCHING_COLOR )
	vColor = vec4( 1.0 );
#endif
#ifdef USE_COLOR_ALPHA
	vColor *= color;
#elif defined( USE_COLOR )
	vColor.rgb *= color;
#endif
#ifdef USE_INSTANCING_COLOR
	vColor.rgb *= instanceColor.rgb;
#endif
#ifdef USE_BATCHING_COLOR
	vColor *= getBatchingColor( getIndirectIndex( gl_DrawID ) );
#endif`,Uc=`#define PI 3.141592653589793
#define PI2 6.283185307179586
#define PI_HALF 1.5707963267948966
#define RECIPROCAL_PI 0.3183098861837907
#define RECIPROCAL_PI2 0.15915494309189535
#define EPSILON 1e-6
#ifndef saturate
#define saturate( a ) clamp( a, 0.0, 1.0 )
#endif
#define whiteComplement( a ) ( 1.0 - saturate( a ) )
float pow2( const in float x ) { return x*x; }
vec3 pow2( const in vec3 x ) { return x*x; }
float pow3( const in float x ) { return x*x*x; }
float pow4( const in float x ) { float x2 = x*x; return x2*x2; }
float max3( const in vec3 v ) { return max( max( v.x, v.y ), v.z ); }
float average( const in vec3 v ) { return dot( v, vec3( 0.3333333 ) ); }
highp float rand( const in vec2 uv ) {
	const highp float a = 12.9898, b = 78.233, c = 43758.5453;
	highp float dt = dot( uv.xy, vec2( a,b ) ), sn = mod( dt, PI );
	return fract( sin( sn ) * c );
}
#ifdef HIGH_PRECISION
	float precisionSafeLength( vec3 v ) { return length( v ); }
#else
	float precisionSafeLength( vec3 v ) {
		float maxComponent = max3( abs( v ) );
		return length( v / maxComponent ) * maxComponent;
	}
#endif
struct IncidentLight {
	vec3 color;
	vec3 direction;
	bool visible;
};
struct ReflectedLight {
	vec3 directDiffuse;
	vec3 directSpecular;
	vec3 indirectDiffuse;
	vec3 indirectSpecular;
};
#ifdef USE_ALPHAHASH
	varying vec3 vPosition;
#endif
vec3 transformDirection( in vec3 dir, in mat4 matrix ) {
	return normalize( ( matrix * vec4( dir, 0.0 ) ).xyz );
}
#define inverseTransformDirection transformDirectionByInverseViewMatrix
vec3 transformNormalByInverseViewMatrix( in vec3 normal, in mat4 viewMatrix ) {
	return normalize( ( vec4( normal, 0.0 ) * viewMatrix ).xyz );
}
vec3 transformDirectionByInverseViewMatrix( in vec3 dir, in mat4 viewMatrix ) {
	return normalize( ( vec4( dir, 0.0 ) * viewMatrix ).xyz );
}
bool isPerspectiveMatrix( mat4 m ) {
	return m[ 2 ][ 3 ] == - 1.0;
}
vec2 equirectUv( in vec3 dir ) {
	float u = atan( dir.z, dir.x ) * RECIPROCAL_PI2 + 0.5;
	float v = asin( clamp( dir.y, - 1.0, 1.0 ) ) * RECIPROCAL_PI + 0.5;
	return vec2( u, v );
}
vec3 BRDF_Lambert( const in vec3 diffuseColor ) {
	return RECIPROCAL_PI * diffuseColor;
}
vec3 F_Schlick( const in vec3 f0, const in float f90, const in float dotVH ) {
	float fresnel = exp2( ( - 5.55473 * dotVH - 6.98316 ) * dotVH );
	return f0 * ( 1.0 - fresnel ) + ( f90 * fresnel );
}
float F_Schlick( const in float f0, const in float f90, const in float dotVH ) {
	float fresnel = exp2( ( - 5.55473 * dotVH - 6.98316 ) * dotVH );
	return f0 * ( 1.0 - fresnel ) + ( f90 * fresnel );
} // validated`,Oc=`vec3 transformedNormal = objectNormal;
#ifdef USE_TANGENT
	vec3 transformedTangent = objectTangent;
#endif
#ifdef USE_BATCHING
	mat3 bm = mat3( batchingMatrix );
	transformedNormal /= vec3( dot( bm[ 0 ], bm[ 0 ] ), dot( bm[ 1 ], bm[ 1 ] ), dot( bm[ 2 ], bm[ 2 ] ) );
	transformedNormal = bm * transformedNormal;
	#ifdef USE_TANGENT
		transformedTangent = bm * transformedTangent;
	#endif
#endif
#ifdef USE_INSTANCING
	mat3 im = mat3( instanceMatrix );
	transformedNormal /= vec3( dot( im[ 0 ], im[ 0 ] ), dot( im[ 1 ], im[ 1 ] ), dot( im[ 2 ], im[ 2 ] ) );
	transformedNormal = im * transformedNormal;
	#ifdef USE_TANGENT
		transformedTangent = im * transformedTangent;
	#endif
#endif
transformedNormal = normalMatrix * transformedNormal;
#ifdef FLIP_SIDED
	transformedNormal = - transformedNormal;
#endif
#ifdef USE_TANGENT
	transformedTangent = ( modelViewMatrix * vec4( transformedTangent, 0.0 ) ).xyz;
#endif`,Bc=`#ifdef USE_DISPLACEMENTMAP
	uniform sampler2D displacementMap;
	uniform float displacementScale;
	uniform float displacementBias;
#endif`,kc=`#ifdef USE_DISPLACEMENTMAP
	transformed += normalize( objectNormal ) * ( texture2D( displacementMap, vDisplacementMapUv ).x * displacementScale + displacementBias );
#endif`,Gc=`#ifdef USE_EMISSIVEMAP
	vec4 emissiveColor = texture2D( emissiveMap, vEmissiveMapUv );
	#ifdef DECODE_VIDEO_TEXTURE_EMISSIVE
		emissiveColor = sRGBTransferEOTF( emissiveColor );
	#endif
	totalEmissiveRadiance *= emissiveColor.rgb;
#endif`,zc=`#ifdef USE_EMISSIVEMAP
	uniform sampler2D emissiveMap;
#endif`,Hc="gl_FragColor = linearToOutputTexel( gl_FragColor );",Vc=`vec4 LinearTransferOETF( in vec4 value ) {
	return value;
}
vec4 sRGBTransferEOTF( in vec4 value ) {
	return vec4( mix( pow( value.rgb * 0.9478672986 + vec3( 0.0521327014 ), vec3( 2.4 ) ), value.rgb * 0.0773993808, vec3( lessThanEqual( value.rgb, vec3( 0.04045 ) ) ) ), value.a );
}
vec4 sRGBTransferOETF( in vec4 value ) {
	return vec4( mix( pow( value.rgb, vec3( 0.41666 ) ) * 1.055 - vec3( 0.055 ), value.rgb * 12.92, vec3( lessThanEqual( value.rgb, vec3( 0.0031308 ) ) ) ), value.a );
}`,Wc=`#ifdef USE_ENVMAP
	#ifdef ENV_WORLDPOS
		vec3 cameraToFrag;
		if ( isOrthographic ) {
			cameraToFrag = normalize( vec3( - viewMatrix[ 0 ][ 2 ], - viewMatrix[ 1 ][ 2 ], - viewMatrix[ 2 ][ 2 ] ) );
		} else {
			cameraToFrag = normalize( vWorldPosition - cameraPosition );
		}
		vec3 worldNormal = transformNormalByInverseViewMatrix( normal, viewMatrix );
		#ifdef ENVMAP_MODE_REFLECTION
			vec3 reflectVec = reflect( cameraToFrag, worldNormal );
		#else
			vec3 reflectVec = refract( cameraToFrag, worldNormal, refractionRatio );
		#endif
	#else
		vec3 reflectVec = vReflect;
	#endif
	#ifdef ENVMAP_TYPE_CUBE
		vec4 envColor = textureCube( envMap, envMapRotation * reflectVec );
		#ifdef ENVMAP_BLENDING_MULTIPLY
			outgoingLight = mix( outgoingLight, outgoingLight * envColor.xyz, specularStrength * reflectivity );
		#elif defined( ENVMAP_BLENDING_MIX )
			outgoingLight = mix( outgoingLight, envColor.xyz, specularStrength * reflectivity );
		#elif defined( ENVMAP_BLENDING_ADD )
			outgoingLight += envColor.xyz * specularStrength * reflectivity;
		#endif
	#endif
#endif`,Xc=`#ifdef USE_ENVMAP
	uniform float envMapIntensity;
	uniform mat3 envMapRotation;
	uniform samplerCube envMap;
	#ifdef ENVMAP_TYPE_PMREM
		float roughnessToMip( const in float roughness ) {
			float r = clamp( roughness, 0.0, 1.0 );
			return ENVMAP_MAX_LOD * r * ( 2.0 - r );
		}
	#endif
#endif`,$c=`#ifdef USE_ENVMAP
	uniform float reflectivity;
	#if defined( USE_BUMPMAP ) || defined( USE_NORMALMAP ) || defined( PHONG ) || defined( LAMBERT )
		#define ENV_WORLDPOS
	#endif
	#ifdef ENV_WORLDPOS
		varying vec3 vWorldPosition;
		uniform float refractionRatio;
	#else
		varying vec3 vReflect;
	#endif
#endif`,qc=`#ifdef USE_ENVMAP
	#if defined( USE_BUMPMAP ) || defined( USE_NORMALMAP ) || defined( PHONG ) || defined( LAMBERT )
		#define ENV_WORLDPOS
	#endif
	#ifdef ENV_WORLDPOS
		
		varying vec3 vWorldPosition;
	#else
		varying vec3 vReflect;
		uniform float refractionRatio;
	#endif
#endif`,Yc=`#ifdef USE_ENVMAP
	#ifdef ENV_WORLDPOS
		vWorldPosition = worldPosition.xyz;
	#else
		vec3 cameraToVertex;
		if ( isOrthographic ) {
			cameraToVertex = normalize( vec3( - viewMatrix[ 0 ][ 2 ], - viewMatrix[ 1 ][ 2 ], - viewMatrix[ 2 ][ 2 ] ) );
		} else {
			cameraToVertex = normalize( worldPosition.xyz - cameraPosition );
		}
		vec3 worldNormal = transformNormalByInverseViewMatrix( transformedNormal, viewMatrix );
		#ifdef ENVMAP_MODE_REFLECTION
			vReflect = reflect( cameraToVertex, worldNormal );
		#else
			vReflect = refract( cameraToVertex, worldNormal, refractionRatio );
		#endif
	#endif
#endif`,Kc=`#ifdef USE_FOG
	vFogDepth = - mvPosition.z;
#endif`,Zc=`#ifdef USE_FOG
	varying float vFogDepth;
#endif`,Jc=`#ifdef USE_FOG
	#ifdef FOG_EXP2
		float fogFactor = 1.0 - exp( - fogDensity * fogDensity * vFogDepth * vFogDepth );
	#else
		float fogFactor = smoothstep( fogNear, fogFar, vFogDepth );
	#endif
	gl_FragColor.rgb = mix( gl_FragColor.rgb, fogColor, fogFactor );
#endif`,Qc=`#ifdef USE_FOG
	uniform vec3 fogColor;
	varying float vFogDepth;
	#ifdef FOG_EXP2
		uniform float fogDensity;
	#else
		uniform float fogNear;
		uniform float fogFar;
	#endif
#endif`,jc=`#ifdef USE_GRADIENTMAP
	uniform sampler2D gradientMap;
#endif
vec3 getGradientIrradiance( vec3 normal, vec3 lightDirection ) {
	float dotNL = dot( normal, lightDirection );
	vec2 coord = vec2( dotNL * 0.5 + 0.5, 0.0 );
	#ifdef USE_GRADIENTMAP
		return vec3( texture2D( gradientMap, coord ).r );
	#else
		vec2 fw = fwidth( coord ) * 0.5;
		return mix( vec3( 0.7 ), vec3( 1.0 ), smoothstep( 0.7 - fw.x, 0.7 + fw.x, coord.x ) );
	#endif
}`,eh=`#ifdef USE_LIGHTMAP
	uniform sampler2D lightMap;
	uniform float lightMapIntensity;
#endif`,th=`LambertMaterial material;
material.diffuseColor = diffuseColor.rgb;
material.specularStrength = specularStrength;`,nh=`varying vec3 vViewPosition;
struct LambertMaterial {
	vec3 diffuseColor;
	float specularStrength;
};
void RE_Direct_Lambert( const in IncidentLight directLight, const in vec3 geometryPosition, const in vec3 geometryNormal, const in vec3 geometryViewDir, const in vec3 geometryClearcoatNormal, const in LambertMaterial material, inout ReflectedLight reflectedLight ) {
	float dotNL = saturate( dot( geometryNormal, directLight.direction ) );
	vec3 irradiance = dotNL * directLight.color;
	reflectedLight.directDiffuse += irradiance * BRDF_Lambert( material.diffuseColor );
}
void RE_IndirectDiffuse_Lambert( const in vec3 irradiance, const in vec3 geometryPosition, const in vec3 geometryNormal, const in vec3 geometryViewDir, const in vec3 geometryClearcoatNormal, const in LambertMaterial material, inout ReflectedLight reflectedLight ) {
	reflectedLight.indirectDiffuse += irradiance * BRDF_Lambert( material.diffuseColor );
}
#define RE_Direct				RE_Direct_Lambert
#define RE_IndirectDiffuse		RE_IndirectDiffuse_Lambert`,ih=`uniform bool receiveShadow;
uniform vec3 ambientLightColor;
#if defined( USE_LIGHT_PROBES )
	uniform vec3 lightProbe[ 9 ];
#endif
vec3 shGetIrradianceAt( in vec3 normal, in vec3 shCoefficients[ 9 ] ) {
	float x = normal.x, y = normal.y, z = normal.z;
	vec3 result = shCoefficients[ 0 ] * 0.886227;
	result += shCoefficients[ 1 ] * 2.0 * 0.511664 * y;
	result += shCoefficients[ 2 ] * 2.0 * 0.511664 * z;
	result += shCoefficients[ 3 ] * 2.0 * 0.511664 * x;
	result += shCoefficients[ 4 ] * 2.0 * 0.429043 * x * y;
	result += shCoefficients[ 5 ] * 2.0 * 0.429043 * y * z;
	result += shCoefficients[ 6 ] * ( 0.743125 * z * z - 0.247708 );
	result += shCoefficients[ 7 ] * 2.0 * 0.429043 * x * z;
	result += shCoefficients[ 8 ] * 0.429043 * ( x * x - y * y );
	return result;
}
vec3 getLightProbeIrradiance( const in vec3 lightProbe[ 9 ], const in vec3 normal ) {
	vec3 worldNormal = transformNormalByInverseViewMatrix( normal, viewMatrix );
	vec3 irradiance = shGetIrradianceAt( worldNormal, lightProbe );
	return irradiance;
}
vec3 getAmbientLightIrradiance( const in vec3 ambientLightColor ) {
	vec3 irradiance = ambientLightColor;
	return irradiance;
}
float getDistanceAttenuation( const in float lightDistance, const in float cutoffDistance, const in float decayExponent ) {
	float distanceFalloff = 1.0 / max( pow( lightDistance, decayExponent ), 0.01 );
	if ( cutoffDistance > 0.0 ) {
		distanceFalloff *= pow2( saturate( 1.0 - pow4( lightDistance / cutoffDistance ) ) );
	}
	return distanceFalloff;
}
float getSpotAttenuation( const in float coneCosine, const in float penumbraCosine, const in float angleCosine ) {
	return smoothstep( coneCosine, penumbraCosine, angleCosine );
}
#if NUM_SUN_LIGHTS > 0
	struct SunLight {
		vec3 direction;
		vec3 color;
	};
	uniform SunLight sunLights[ NUM_SUN_LIGHTS ];
	void getSunLightInfo( const in SunLight sunLight, out IncidentLight light ) {
		light.color = sunLight.color;
		light.direction = sunLight.direction;
		light.visible = true;
	}
#endif
#if NUM_DIR_LIGHTS > 0
	struct DirectionalLight {
		vec3 direction;
		vec3 color;
	};
	uniform DirectionalLight directionalLights[ NUM_DIR_LIGHTS ];
	void getDirectionalLightInfo( const in DirectionalLight directionalLight, out IncidentLight light ) {
		light.color = directionalLight.color;
		light.direction = directionalLight.direction;
		light.visible = true;
	}
#endif
#if NUM_POINT_LIGHTS > 0
	struct PointLight {
		vec3 position;
		vec3 color;
		float distance;
		float decay;
	};
	uniform PointLight pointLights[ NUM_POINT_LIGHTS ];
	void getPointLightInfo( const in PointLight pointLight, const in vec3 geometryPosition, out IncidentLight light ) {
		vec3 lVector = pointLight.position - geometryPosition;
		light.direction = normalize( lVector );
		float lightDistance = length( lVector );
		light.color = pointLight.color;
		light.color *= getDistanceAttenuation( lightDistance, pointLight.distance, pointLight.decay );
		light.visible = ( light.color != vec3( 0.0 ) );
	}
#endif
#if NUM_SPOT_LIGHTS > 0
	struct SpotLight {
		vec3 position;
		vec3 direction;
		vec3 color;
		float distance;
		float decay;
		float coneCos;
		float penumbraCos;
	};
	uniform SpotLight spotLights[ NUM_SPOT_LIGHTS ];
	void getSpotLightInfo( const in SpotLight spotLight, const in vec3 geometryPosition, out IncidentLight light ) {
		vec3 lVector = spotLight.position - geometryPosition;
		light.direction = normalize( lVector );
		float angleCos = dot( light.direction, spotLight.direction );
		float spotAttenuation = getSpotAttenuation( spotLight.coneCos, spotLight.penumbraCos, angleCos );
		if ( spotAttenuation > 0.0 ) {
			float lightDistance = length( lVector );
			light.color = spotLight.color * spotAttenuation;
			light.color *= getDistanceAttenuation( lightDistance, spotLight.distance, spotLight.decay );
			light.visible = ( light.color != vec3( 0.0 ) );
		} else {
			light.color = vec3( 0.0 );
			light.visible = false;
		}
	}
#endif
#if NUM_RECT_AREA_LIGHTS > 0
	struct RectAreaLight {
		vec3 color;
		vec3 position;
		vec3 halfWidth;
		vec3 halfHeight;
	};
	uniform sampler2D ltc_1;	uniform sampler2D ltc_2;
	uniform RectAreaLight rectAreaLights[ NUM_RECT_AREA_LIGHTS ];
#endif
#if NUM_HEMI_LIGHTS > 0
	struct HemisphereLight {
		vec3 direction;
		vec3 skyColor;
		vec3 groundColor;
	};
	uniform HemisphereLight hemisphereLights[ NUM_HEMI_LIGHTS ];
	vec3 getHemisphereLightIrradiance( const in HemisphereLight hemiLight, const in vec3 normal ) {
		float dotNL = dot( normal, hemiLight.direction );
		float hemiDiffuseWeight = 0.5 * dotNL + 0.5;
		vec3 irradiance = mix( hemiLight.groundColor, hemiLight.skyColor, hemiDiffuseWeight );
		return irradiance;
	}
#endif
#include <lightprobes_pars_fragment>`,sh=`#ifdef USE_ENVMAP
	vec3 getIBLIrradiance( const in vec3 normal ) {
		#ifdef ENVMAP_TYPE_PMREM
			vec3 worldNormal = transformNormalByInverseViewMatrix( normal, viewMatrix );
			vec4 envMapColor = textureLod( envMap, envMapRotation * worldNormal, ENVMAP_MAX_LOD );
			return PI * envMapColor.rgb * envMapIntensity;
		#else
			return vec3( 0.0 );
		#endif
	}
	vec3 getIBLRadiance( const in vec3 viewDir, const in vec3 normal, const in float roughness ) {
		#ifdef ENVMAP_TYPE_PMREM
			vec3 reflectVec = reflect( - viewDir, normal );
			reflectVec = normalize( mix( reflectVec, normal, pow4( roughness ) ) );
			reflectVec = transformDirectionByInverseViewMatrix( reflectVec, viewMatrix );
			vec4 envMapColor = textureLod( envMap, envMapRotation * reflectVec, roughnessToMip( roughness ) );
			return envMapColor.rgb * envMapIntensity;
		#else
			return vec3( 0.0 );
		#endif
	}
	#ifdef USE_RETROREFLECTION
		vec3 getIBLRetroRadiance( const in vec3 viewDir, const in vec3 normal, const in float roughness ) {
			#ifdef ENVMAP_TYPE_PMREM
				vec3 retroVec = normalize( mix( viewDir, normal, pow4( roughness ) ) );
				retroVec = transformDirectionByInverseViewMatrix( retroVec, viewMatrix );
				vec4 envMapColor = textureLod( envMap, envMapRotation * retroVec, roughnessToMip( roughness ) );
				return envMapColor.rgb * envMapIntensity;
			#else
				return vec3( 0.0 );
			#endif
		}
	#endif
	#ifdef USE_ANISOTROPY
		vec3 getIBLAnisotropyRadiance( const in vec3 viewDir, const in vec3 normal, const in float roughness, const in vec3 bitangent, const in float anisotropy ) {
			#ifdef ENVMAP_TYPE_PMREM
				vec3 bentNormal = cross( bitangent, viewDir );
				bentNormal = normalize( cross( bentNormal, bitangent ) );
				bentNormal = normalize( mix( bentNormal, normal, pow2( pow2( 1.0 - anisotropy * ( 1.0 - roughness ) ) ) ) );
				return getIBLRadiance( viewDir, bentNormal, roughness );
			#else
				return vec3( 0.0 );
			#endif
		}
		#ifdef USE_RETROREFLECTION
			vec3 getIBLAnisotropyRetroRadiance( const in vec3 viewDir, const in vec3 normal, const in float roughness, const in vec3 bitangent, const in float anisotropy ) {
				#ifdef ENVMAP_TYPE_PMREM
					vec3 bentNormal = cross( bitangent, viewDir );
					bentNormal = normalize( cross( bentNormal, bitangent ) );
					bentNormal = normalize( mix( bentNormal, normal, pow2( pow2( 1.0 - anisotropy * ( 1.0 - roughness ) ) ) ) );
					return getIBLRetroRadiance( viewDir, bentNormal, roughness );
				#else
					return vec3( 0.0 );
				#endif
			}
		#endif
	#endif
#endif`,rh=`ToonMaterial material;
material.diffuseColor = diffuseColor.rgb;`,ah=`varying vec3 vViewPosition;
struct ToonMaterial {
	vec3 diffuseColor;
};
void RE_Direct_Toon( const in IncidentLight directLight, const in vec3 geometryPosition, const in vec3 geometryNormal, const in vec3 geometryViewDir, const in vec3 geometryClearcoatNormal, const in ToonMaterial material, inout ReflectedLight reflectedLight ) {
	vec3 irradiance = getGradientIrradiance( geometryNormal, directLight.direction ) * directLight.color;
	reflectedLight.directDiffuse += irradiance * BRDF_Lambert( material.diffuseColor );
}
void RE_IndirectDiffuse_Toon( const in vec3 irradiance, const in vec3 geometryPosition, const in vec3 geometryNormal, const in vec3 geometryViewDir, const in vec3 geometryClearcoatNormal, const in ToonMaterial material, inout ReflectedLight reflectedLight ) {
	reflectedLight.indirectDiffuse += irradiance * BRDF_Lambert( material.diffuseColor );
}
#define RE_Direct				RE_Direct_Toon
#define RE_IndirectDiffuse		RE_IndirectDiffuse_Toon`,oh=`BlinnPhongMaterial material;
material.diffuseColor = diffuseColor.rgb;
material.specularColor = specular;
material.specularShininess = shininess;
material.specularStrength = specularStrength;`,lh=`varying vec3 vViewPosition;
struct BlinnPhongMaterial {
	vec3 diffuseColor;
	vec3 specularColor;
	float specularShininess;
	float specularStrength;
};
void RE_Direct_BlinnPhong( const in IncidentLight directLight, const in vec3 geometryPosition, const in vec3 geometryNormal, const in vec3 geometryViewDir, const in vec3 geometryClearcoatNormal, const in BlinnPhongMaterial material, inout ReflectedLight reflectedLight ) {
	float dotNL = saturate( dot( geometryNormal, directLight.direction ) );
	vec3 irradiance = dotNL * directLight.color;
	reflectedLight.directDiffuse += irradiance * BRDF_Lambert( material.diffuseColor );
	reflectedLight.directSpecular += irradiance * BRDF_BlinnPhong( directLight.direction, geometryViewDir, geometryNormal, material.specularColor, material.specularShininess ) * material.specularStrength;
}
void RE_IndirectDiffuse_BlinnPhong( const in vec3 irradiance, const in vec3 geometryPosition, const in vec3 geometryNormal, const in vec3 geometryViewDir, const in vec3 geometryClearcoatNormal, const in BlinnPhongMaterial material, inout ReflectedLight reflectedLight ) {
	reflectedLight.indirectDiffuse += irradiance * BRDF_Lambert( material.diffuseColor );
}
#define RE_Direct				RE_Direct_BlinnPhong
#define RE_IndirectDiffuse		RE_IndirectDiffuse_BlinnPhong`,ch=`PhysicalMaterial material;
material.diffuseColor = diffuseColor.rgb;
material.diffuseContribution = diffuseColor.rgb * ( 1.0 - metalnessFactor );
material.metalness = metalnessFactor;
vec3 dxy = max( abs( dFdx( nonPerturbedNormal ) ), abs( dFdy( nonPerturbedNormal ) ) );
float geometryRoughness = max( max( dxy.x, dxy.y ), dxy.z );
material.roughness = max( roughnessFactor, 0.045 );
material.roughness += geometryRoughness;
material.roughness = min( material.roughness, 1.0 );
#ifdef USE_DIFFUSE_ROUGHNESS
	float diffuseRoughnessFactor = diffuseRoughness;
	#ifdef USE_DIFFUSE_ROUGHNESSMAP
		diffuseRoughnessFactor *= texture2D( diffuseRoughnessMap, vDiffuseRoughnessMapUv ).r;
	#endif
	material.diffuseRoughness = saturate( diffuseRoughnessFactor );
#endif
#ifdef IOR
	material.ior = ior;
	#ifdef USE_SPECULAR
		float specularIntensityFactor = specularIntensity;
		vec3 specularColorFactor = specularColor;
		#ifdef USE_SPECULAR_COLORMAP
			specularColorFactor *= texture2D( specularColorMap, vSpecularColorMapUv ).rgb;
		#endif
		#ifdef USE_SPECULAR_INTENSITYMAP
			specularIntensityFactor *= texture2D( specularIntensityMap, vSpecularIntensityMapUv ).a;
		#endif
		material.specularF90 = mix( specularIntensityFactor, 1.0, metalnessFactor );
	#else
		float specularIntensityFactor = 1.0;
		vec3 specularColorFactor = vec3( 1.0 );
		material.specularF90 = 1.0;
	#endif
	material.specularColor = min( pow2( ( material.ior - 1.0 ) / ( material.ior + 1.0 ) ) * specularColorFactor, vec3( 1.0 ) ) * specularIntensityFactor;
	material.specularColorBlended = mix( material.specularColor, diffuseColor.rgb, metalnessFactor );
#else
	material.specularColor = vec3( 0.04 );
	material.specularColorBlended = mix( material.specularColor, diffuseColor.rgb, metalnessFactor );
	material.specularF90 = 1.0;
#endif
#ifdef USE_CLEARCOAT
	material.clearcoat = clearcoat;
	material.clearcoatRoughness = clearcoatRoughness;
	material.clearcoatF0 = vec3( 0.04 );
	material.clearcoatF90 = 1.0;
	#ifdef USE_CLEARCOATMAP
		material.clearcoat *= texture2D( clearcoatMap, vClearcoatMapUv ).x;
	#endif
	#ifdef USE_CLEARCOAT_ROUGHNESSMAP
		material.clearcoatRoughness *= texture2D( clearcoatRoughnessMap, vClearcoatRoughnessMapUv ).y;
	#endif
	material.clearcoat = saturate( material.clearcoat );	material.clearcoatRoughness = max( material.clearcoatRoughness, 0.045 );
	material.clearcoatRoughness += geometryRoughness;
	material.clearcoatRoughness = min( material.clearcoatRoughness, 1.0 );
#endif
#ifdef USE_DISPERSION
	material.dispersion = dispersion;
#endif
#ifdef USE_RETROREFLECTION
	material.retroreflectivity = retroreflectivity;
#endif
#ifdef USE_IRIDESCENCE
	material.iridescence = iridescence;
	material.iridescenceIOR = iridescenceIOR;
	#ifdef USE_IRIDESCENCEMAP
		material.iridescence *= texture2D( iridescenceMap, vIridescenceMapUv ).r;
	#endif
	#ifdef USE_IRIDESCENCE_THICKNESSMAP
		material.iridescenceThickness = (iridescenceThicknessMaximum - iridescenceThicknessMinimum) * texture2D( iridescenceThicknessMap, vIridescenceThicknessMapUv ).g + iridescenceThicknessMinimum;
	#else
		material.iridescenceThickness = iridescenceThicknessMaximum;
	#endif
#endif
#ifdef USE_SHEEN
	material.sheenColor = sheenColor;
	#ifdef USE_SHEEN_COLORMAP
		material.sheenColor *= texture2D( sheenColorMap, vSheenColorMapUv ).rgb;
	#endif
	material.sheenRoughness = clamp( sheenRoughness, 0.0001, 1.0 );
	#ifdef USE_SHEEN_ROUGHNESSMAP
		material.sheenRoughness *= texture2D( sheenRoughnessMap, vSheenRoughnessMapUv ).a;
	#endif
#endif
#ifdef USE_ANISOTROPY
	#ifdef USE_ANISOTROPYMAP
		mat2 anisotropyMat = mat2( anisotropyVector.x, anisotropyVector.y, - anisotropyVector.y, anisotropyVector.x );
		vec3 anisotropyPolar = texture2D( anisotropyMap, vAnisotropyMapUv ).rgb;
		vec2 anisotropyV = anisotropyMat * normalize( 2.0 * anisotropyPolar.rg - vec2( 1.0 ) ) * anisotropyPolar.b;
	#else
		vec2 anisotropyV = anisotropyVector;
	#endif
	material.anisotropy = length( anisotropyV );
	if( material.anisotropy == 0.0 ) {
		anisotropyV = vec2( 1.0, 0.0 );
	} else {
		anisotropyV /= material.anisotropy;
		material.anisotropy = saturate( material.anisotropy );
	}
	material.alphaT = mix( pow2( material.roughness ), 1.0, pow2( material.anisotropy ) );
	material.anisotropyT = tbn[ 0 ] * anisotropyV.x + tbn[ 1 ] * anisotropyV.y;
	material.anisotropyB = tbn[ 1 ] * anisotropyV.x - tbn[ 0 ] * anisotropyV.y;
#endif`,hh=`uniform sampler2D dfgLUT;
struct PhysicalMaterial {
	vec3 diffuseColor;
	vec3 diffuseContribution;
	vec3 specularColor;
	vec3 specularColorBlended;
	float roughness;
	float metalness;
	float specularF90;
	float dispersion;
	vec2 dfg;
	vec3 multiScatteringCompensation;
	#ifdef USE_DIFFUSE_ROUGHNESS
		float diffuseRoughness;
	#endif
	#ifdef USE_RETROREFLECTION
		float retroreflectivity;
	#endif
	#ifdef USE_CLEARCOAT
		float clearcoat;
		float clearcoatRoughness;
		vec3 clearcoatF0;
		float clearcoatF90;
	#endif
	#ifdef USE_IRIDESCENCE
		float iridescence;
		float iridescenceIOR;
		float iridescenceThickness;
		vec3 iridescenceFresnel;
		vec3 iridescenceF0Dielectric;
		vec3 iridescenceF0Metallic;
	#endif
	#ifdef USE_SHEEN
		vec3 sheenColor;
		float sheenRoughness;
	#endif
	#ifdef IOR
		float ior;
	#endif
	#ifdef USE_TRANSMISSION
		float transmission;
		float transmissionAlpha;
		float thickness;
		float attenuationDistance;
		vec3 attenuationColor;
	#endif
	#ifdef USE_ANISOTROPY
		float anisotropy;
		float alphaT;
		vec3 anisotropyT;
		vec3 anisotropyB;
	#endif
};
vec3 clearcoatSpecularDirect = vec3( 0.0 );
vec3 clearcoatSpecularIndirect = vec3( 0.0 );
vec3 sheenSpecularDirect = vec3( 0.0 );
vec3 sheenSpecularIndirect = vec3(0.0 );
vec3 Schlick_to_F0( const in vec3 f, const in float f90, const in float dotVH ) {
    float x = clamp( 1.0 - dotVH, 0.0, 1.0 );
    float x2 = x * x;
    float x5 = clamp( x * x2 * x2, 0.0, 0.9999 );
    return ( f - vec3( f90 ) * x5 ) / ( 1.0 - x5 );
}
#ifdef USE_DIFFUSE_ROUGHNESS
	const float EON_EPSILON = 1e-7;
	float FON_DirectionalAlbedo( const in float mu, const in float roughness, const in float A ) {
		float muComp = 1.0 - mu;
		float gOverPi = muComp * ( 0.0571085289 + muComp * ( 0.491881867 + muComp * ( - 0.332181442 + muComp * 0.0714429953 ) ) );
		return A * ( 1.0 + roughness * gOverPi );
	}
	vec3 BRDF_EON( const in vec3 lightDir, const in vec3 viewDir, const in vec3 normal, const in vec3 diffuseColor, const in float roughness ) {
		vec3 rho = saturate( diffuseColor );
		if ( roughness <= EON_EPSILON ) return BRDF_Lambert( rho );
		float dotNL = saturate( dot( normal, lightDir ) );
		float dotNV = saturate( dot( normal, viewDir ) );
		float s = dot( lightDir, viewDir ) - dotNL * dotNV;
		float sOverT = ( s > 0.0 ) ? s / max( max( dotNL, dotNV ), EON_EPSILON ) : s;
		float A = 1.0 / ( 1.0 + ( 0.5 - 2.0 / ( 3.0 * PI ) ) * roughness );
		vec3 singleScatter = rho * RECIPROCAL_PI * A * ( 1.0 + roughness * sOverT );
		float averageAlbedo = A * ( 1.0 + ( 2.0 / 3.0 - 28.0 / ( 15.0 * PI ) ) * roughness );
		float albedoV = FON_DirectionalAlbedo( dotNV, roughness, A );
		float albedoL = FON_DirectionalAlbedo( dotNL, roughness, A );
		vec3 rhoMultiScatter = rho * rho * averageAlbedo / max( vec3( EON_EPSILON ), vec3( 1.0 ) - rho * ( 1.0 - averageAlbedo ) );
		vec3 multiScatter = rhoMultiScatter * RECIPROCAL_PI
			* max( EON_EPSILON, 1.0 - albedoV )
			* max( EON_EPSILON, 1.0 - albedoL )
			/ max( EON_EPSILON, 1.0 - averageAlbedo );
		return singleScatter + multiScatter;
	}
	vec3 EON_DirectionalAlbedo( const in vec3 diffuseColor, const in float roughness, const in float dotNV ) {
		vec3 rho = saturate( diffuseColor );
		if ( roughness <= EON_EPSILON ) return rho;
		float A = 1.0 / ( 1.0 + ( 0.5 - 2.0 / ( 3.0 * PI ) ) * roughness );
		float directionalAlbedo = FON_DirectionalAlbedo( dotNV, roughness, A );
		float averageAlbedo = A * ( 1.0 + ( 2.0 / 3.0 - 28.0 / ( 15.0 * PI ) ) * roughness );
		vec3 rhoMultiScatter = rho * rho * averageAlbedo / max( vec3( EON_EPSILON ), vec3( 1.0 ) - rho * ( 1.0 - averageAlbedo ) );
		return rho * directionalAlbedo + rhoMultiScatter * ( 1.0 - directionalAlbedo );
	}
#endif
float V_GGX_SmithCorrelated( const in float alpha, const in float dotNL, const in float dotNV ) {
	float a2 = pow2( alpha );
	float gv = dotNL * sqrt( a2 + ( 1.0 - a2 ) * pow2( dotNV ) );
	float gl = dotNV * sqrt( a2 + ( 1.0 - a2 ) * pow2( dotNL ) );
	return 0.5 / max( gv + gl, EPSILON );
}
float D_GGX( const in float alpha, const in float dotNH ) {
	float a2 = pow2( alpha );
	float denom = pow2( dotNH ) * ( a2 - 1.0 ) + 1.0;
	return RECIPROCAL_PI * a2 / pow2( denom );
}
#ifdef USE_ANISOTROPY
	float V_GGX_SmithCorrelated_Anisotropic( const in float alphaT, const in float alphaB, const in float dotTV, const in float dotBV, const in float dotTL, const in float dotBL, const in float dotNV, const in float dotNL ) {
		float gv = dotNL * length( vec3( alphaT * dotTV, alphaB * dotBV, dotNV ) );
		float gl = dotNV * length( vec3( alphaT * dotTL, alphaB * dotBL, dotNL ) );
		return 0.5 / max( gv + gl, EPSILON );
	}
	float D_GGX_Anisotropic( const in float alphaT, const in float alphaB, const in float dotNH, const in float dotTH, const in float dotBH ) {
		float a2 = alphaT * alphaB;
		highp vec3 v = vec3( alphaB * dotTH, alphaT * dotBH, a2 * dotNH );
		highp float v2 = dot( v, v );
		float w2 = a2 / v2;
		return RECIPROCAL_PI * a2 * pow2 ( w2 );
	}
#endif
#ifdef USE_CLEARCOAT
	vec3 BRDF_GGX_Clearcoat( const in vec3 lightDir, const in vec3 viewDir, const in vec3 normal, const in PhysicalMaterial material) {
		vec3 f0 = material.clearcoatF0;
		float f90 = material.clearcoatF90;
		float roughness = max( material.clearcoatRoughness, 0.045 );
		float alpha = pow2( roughness );
		vec3 halfDir = normalize( lightDir + viewDir );
		float dotNL = saturate( dot( normal, lightDir ) );
		float dotNV = saturate( dot( normal, viewDir ) );
		float dotNH = saturate( dot( normal, halfDir ) );
		float dotVH = saturate( dot( viewDir, halfDir ) );
		vec3 F = F_Schlick( f0, f90, dotVH );
		float V = V_GGX_SmithCorrelated( alpha, dotNL, dotNV );
		float D = D_GGX( alpha, dotNH );
		return F * ( V * D );
	}
#endif
vec3 BRDF_GGX( const in vec3 lightDir, const in vec3 viewDir, const in vec3 normal, const in PhysicalMaterial material ) {
	vec3 f0 = material.specularColorBlended;
	float f90 = material.specularF90;
	float roughness = max( material.roughness, 0.045 );
	float alpha = pow2( roughness );
	vec3 halfDir = normalize( lightDir + viewDir );
	float dotNL = saturate( dot( normal, lightDir ) );
	float dotNV = saturate( dot( normal, viewDir ) );
	float dotNH = saturate( dot( normal, halfDir ) );
	float dotVH = saturate( dot( viewDir, halfDir ) );
	vec3 F = F_Schlick( f0, f90, dotVH );
	#ifdef USE_IRIDESCENCE
		F = mix( F, material.iridescenceFresnel, material.iridescence );
	#endif
	#ifdef USE_ANISOTROPY
		float dotTL = dot( material.anisotropyT, lightDir );
		float dotTV = dot( material.anisotropyT, viewDir );
		float dotTH = dot( material.anisotropyT, halfDir );
		float dotBL = dot( material.anisotropyB, lightDir );
		float dotBV = dot( material.anisotropyB, viewDir );
		float dotBH = dot( material.anisotropyB, halfDir );
		float alphaT = max( material.alphaT, alpha );
		float V = V_GGX_SmithCorrelated_Anisotropic( alphaT, alpha, dotTV, dotBV, dotTL, dotBL, dotNV, dotNL );
		float D = D_GGX_Anisotropic( alphaT, alpha, dotNH, dotTH, dotBH );
	#else
		float V = V_GGX_SmithCorrelated( alpha, dotNL, dotNV );
		float D = D_GGX( alpha, dotNH );
	#endif
	return F * ( V * D );
}
vec2 LTC_Uv( const in vec3 N, const in vec3 V, const in float roughness ) {
	const float LUT_SIZE = 64.0;
	const float LUT_SCALE = ( LUT_SIZE - 1.0 ) / LUT_SIZE;
	const float LUT_BIAS = 0.5 / LUT_SIZE;
	float dotNV = saturate( dot( N, V ) );
	vec2 uv = vec2( roughness, sqrt( 1.0 - dotNV ) );
	uv = uv * LUT_SCALE + LUT_BIAS;
	return uv;
}
float LTC_ClippedSphereFormFactor( const in vec3 f ) {
	float l = length( f );
	return max( ( l * l + f.z ) / ( l + 1.0 ), 0.0 );
}
vec3 LTC_EdgeVectorFormFactor( const in vec3 v1, const in vec3 v2 ) {
	float x = dot( v1, v2 );
	float y = abs( x );
	float a = 0.8543985 + ( 0.4965155 + 0.0145206 * y ) * y;
	float b = 3.4175940 + ( 4.1616724 + y ) * y;
	float v = a / b;
	float theta_sintheta = ( x > 0.0 ) ? v : 0.5 * inversesqrt( max( 1.0 - x * x, 1e-7 ) ) - v;
	return cross( v1, v2 ) * theta_sintheta;
}
vec3 LTC_Evaluate( const in vec3 N, const in vec3 V, const in vec3 P, const in mat3 mInv, const in vec3 rectCoords[ 4 ] ) {
	vec3 v1 = rectCoords[ 1 ] - rectCoords[ 0 ];
	vec3 v2 = rectCoords[ 3 ] - rectCoords[ 0 ];
	vec3 lightNormal = cross( v1, v2 );
	if( dot( lightNormal, P - rectCoords[ 0 ] ) < 0.0 ) return vec3( 0.0 );
	vec3 T1, T2;
	T1 = normalize( V - N * dot( V, N ) );
	T2 = - cross( N, T1 );
	mat3 mat = mInv * transpose( mat3( T1, T2, N ) );
	vec3 coords[ 4 ];
	coords[ 0 ] = mat * ( rectCoords[ 0 ] - P );
	coords[ 1 ] = mat * ( rectCoords[ 1 ] - P );
	coords[ 2 ] = mat * ( rectCoords[ 2 ] - P );
	coords[ 3 ] = mat * ( rectCoords[ 3 ] - P );
	coords[ 0 ] = normalize( coords[ 0 ] );
	coords[ 1 ] = normalize( coords[ 1 ] );
	coords[ 2 ] = normalize( coords[ 2 ] );
	coords[ 3 ] = normalize( coords[ 3 ] );
	vec3 vectorFormFactor = vec3( 0.0 );
	vectorFormFactor += LTC_EdgeVectorFormFactor( coords[ 0 ], coords[ 1 ] );
	vectorFormFactor += LTC_EdgeVectorFormFactor( coords[ 1 ], coords[ 2 ] );
	vectorFormFactor += LTC_EdgeVectorFormFactor( coords[ 2 ], coords[ 3 ] );
	vectorFormFactor += LTC_EdgeVectorFormFactor( coords[ 3 ], coords[ 0 ] );
	float result = LTC_ClippedSphereFormFactor( vectorFormFactor );
	return vec3( result );
}
#if defined( USE_SHEEN )
float D_Charlie( float roughness, float dotNH ) {
	float alpha = pow2( roughness );
	float invAlpha = 1.0 / alpha;
	float cos2h = dotNH * dotNH;
	float sin2h = max( 1.0 - cos2h, 0.0078125 );
	return ( 2.0 + invAlpha ) * pow( sin2h, invAlpha * 0.5 ) / ( 2.0 * PI );
}
float V_Neubelt( float dotNV, float dotNL ) {
	return saturate( 1.0 / ( 4.0 * ( dotNL + dotNV - dotNL * dotNV ) ) );
}
vec3 BRDF_Sheen( const in vec3 lightDir, const in vec3 viewDir, const in vec3 normal, vec3 sheenColor, const in float sheenRoughness ) {
	vec3 halfDir = normalize( lightDir + viewDir );
	float dotNL = saturate( dot( normal, lightDir ) );
	float dotNV = saturate( dot( normal, viewDir ) );
	float dotNH = saturate( dot( normal, halfDir ) );
	float D = D_Charlie( sheenRoughness, dotNH );
	float V = V_Neubelt( dotNV, dotNL );
	return sheenColor * ( D * V );
}
#endif
float IBLSheenBRDF( const in vec3 normal, const in vec3 viewDir, const in float roughness ) {
	float dotNV = saturate( dot( normal, viewDir ) );
	float r2 = roughness * roughness;
	float rInv = 1.0 / ( roughness + 0.1 );
	float a = -1.9362 + 1.0678 * roughness + 0.4573 * r2 - 0.8469 * rInv;
	float b = -0.6014 + 0.5538 * roughness - 0.4670 * r2 - 0.1255 * rInv;
	float DG = exp( a * dotNV + b );
	return saturate( DG );
}
vec3 EnvironmentBRDF( const in vec3 normal, const in vec3 viewDir, const in vec3 specularColor, const in float specularF90, const in float roughness ) {
	float dotNV = saturate( dot( normal, viewDir ) );
	vec2 fab = texture2D( dfgLUT, vec2( roughness, dotNV ) ).rg;
	return specularColor * fab.x + specularF90 * fab.y;
}
#ifdef USE_IRIDESCENCE
void computeMultiscatteringIridescence( const in vec2 fab, const in vec3 specularColor, const in float specularF90, const in float iridescence, const in vec3 iridescenceF0, inout vec3 singleScatter, inout vec3 multiScatter ) {
#else
void computeMultiscattering( const in vec2 fab, const in vec3 specularColor, const in float specularF90, inout vec3 singleScatter, inout vec3 multiScatter ) {
#endif
	#ifdef USE_IRIDESCENCE
		vec3 Fr = mix( specularColor, iridescenceF0, iridescence );
	#else
		vec3 Fr = specularColor;
	#endif
	vec3 FssEss = Fr * fab.x + specularF90 * fab.y;
	float Ess = fab.x + fab.y;
	float Ems = 1.0 - Ess;
	vec3 Favg = Fr + ( 1.0 - Fr ) * 0.047619;	vec3 Fms = FssEss * Favg / ( 1.0 - Ems * Favg );
	singleScatter += FssEss;
	multiScatter += Fms * Ems;
}
#if NUM_RECT_AREA_LIGHTS > 0
	void RE_Direct_RectArea_Physical( const in RectAreaLight rectAreaLight, const in vec3 geometryPosition, const in vec3 geometryNormal, const in vec3 geometryViewDir, const in vec3 geometryClearcoatNormal, const in PhysicalMaterial material, inout ReflectedLight reflectedLight ) {
		vec3 normal = geometryNormal;
		vec3 viewDir = geometryViewDir;
		vec3 position = geometryPosition;
		vec3 lightPos = rectAreaLight.position;
		vec3 halfWidth = rectAreaLight.halfWidth;
		vec3 halfHeight = rectAreaLight.halfHeight;
		vec3 lightColor = rectAreaLight.color;
		float roughness = material.roughness;
		vec3 rectCoords[ 4 ];
		rectCoords[ 0 ] = lightPos + halfWidth - halfHeight;		rectCoords[ 1 ] = lightPos - halfWidth - halfHeight;
		rectCoords[ 2 ] = lightPos - halfWidth + halfHeight;
		rectCoords[ 3 ] = lightPos + halfWidth + halfHeight;
		vec2 uv = LTC_Uv( normal, viewDir, roughness );
		vec4 t1 = texture2D( ltc_1, uv );
		vec4 t2 = texture2D( ltc_2, uv );
		mat3 mInv = mat3(
			vec3( t1.x, 0, t1.y ),
			vec3(    0, 1,    0 ),
			vec3( t1.z, 0, t1.w )
		);
		vec3 fresnel = ( material.specularColorBlended * t2.x + ( material.specularF90 - material.specularColorBlended ) * t2.y );
		reflectedLight.directSpecular += lightColor * fresnel * LTC_Evaluate( normal, viewDir, position, mInv, rectCoords );
		reflectedLight.directDiffuse += lightColor * material.diffuseContribution * LTC_Evaluate( normal, viewDir, position, mat3( 1.0 ), rectCoords );
		#ifdef USE_CLEARCOAT
			vec3 Ncc = geometryClearcoatNormal;
			vec2 uvClearcoat = LTC_Uv( Ncc, viewDir, material.clearcoatRoughness );
			vec4 t1Clearcoat = texture2D( ltc_1, uvClearcoat );
			vec4 t2Clearcoat = texture2D( ltc_2, uvClearcoat );
			mat3 mInvClearcoat = mat3(
				vec3( t1Clearcoat.x, 0, t1Clearcoat.y ),
				vec3(             0, 1,             0 ),
				vec3( t1Clearcoat.z, 0, t1Clearcoat.w )
			);
			vec3 fresnelClearcoat = material.clearcoatF0 * t2Clearcoat.x + ( material.clearcoatF90 - material.clearcoatF0 ) * t2Clearcoat.y;
			clearcoatSpecularDirect += lightColor * fresnelClearcoat * LTC_Evaluate( Ncc, viewDir, position, mInvClearcoat, rectCoords );
		#endif
	}
#endif
void RE_Direct_Physical( const in IncidentLight directLight, const in vec3 geometryPosition, const in vec3 geometryNormal, const in vec3 geometryViewDir, const in vec3 geometryClearcoatNormal, const in PhysicalMaterial material, inout ReflectedLight reflectedLight ) {
	float dotNL = saturate( dot( geometryNormal, directLight.direction ) );
	vec3 irradiance = dotNL * directLight.color;
	#ifdef USE_CLEARCOAT
		float dotNLcc = saturate( dot( geometryClearcoatNormal, directLight.direction ) );
		vec3 ccIrradiance = dotNLcc * directLight.color;
		clearcoatSpecularDirect += ccIrradiance * BRDF_GGX_Clearcoat( directLight.direction, geometryViewDir, geometryClearcoatNormal, material );
	#endif
	#ifdef USE_SHEEN
 
 		sheenSpecularDirect += irradiance * BRDF_Sheen( directLight.direction, geometryViewDir, geometryNormal, material.sheenColor, material.sheenRoughness );
 
 		float sheenAlbedoV = IBLSheenBRDF( geometryNormal, geometryViewDir, material.sheenRoughness );
 		float sheenAlbedoL = IBLSheenBRDF( geometryNormal, directLight.direction, material.sheenRoughness );
 
 		float sheenEnergyComp = 1.0 - max3( material.sheenColor ) * max( sheenAlbedoV, sheenAlbedoL );
 
 		irradiance *= sheenEnergyComp;
 
 	#endif
	vec3 specularBRDF = BRDF_GGX( directLight.direction, geometryViewDir, geometryNormal, material );
	#ifdef USE_RETROREFLECTION
		vec3 retroViewDir = reflect( - geometryViewDir, geometryNormal );
		vec3 retroSpecularBRDF = BRDF_GGX( directLight.direction, retroViewDir, geometryNormal, material );
		specularBRDF = mix( specularBRDF, retroSpecularBRDF, saturate( material.retroreflectivity ) );
	#endif
	reflectedLight.directSpecular += irradiance * specularBRDF * material.multiScatteringCompensation;
	vec3 halfDir = normalize( directLight.direction + geometryViewDir );
	float dotVH = saturate( dot( geometryViewDir, halfDir ) );
	vec3 F = F_Schlick( material.specularColor, material.specularF90, dotVH );
	#ifdef USE_RETROREFLECTION
		vec3 retroHalfDir = normalize( directLight.direction + retroViewDir );
		float dotRetroVH = saturate( dot( retroViewDir, retroHalfDir ) );
		vec3 retroF = F_Schlick( material.specularColor, material.specularF90, dotRetroVH );
		F = mix( F, retroF, saturate( material.retroreflectivity ) );
	#endif
	#ifdef USE_DIFFUSE_ROUGHNESS
		vec3 diffuseBRDF = BRDF_EON( directLight.direction, geometryViewDir, geometryNormal, material.diffuseColor, material.diffuseRoughness ) * ( 1.0 - material.metalness );
	#else
		vec3 diffuseBRDF = BRDF_Lambert( material.diffuseContribution );
	#endif
	reflectedLight.directDiffuse += irradiance * diffuseBRDF * ( 1.0 - F );
}
void RE_IndirectDiffuse_Physical( const in vec3 irradiance, const in vec3 geometryPosition, const in vec3 geometryNormal, const in vec3 geometryViewDir, const in vec3 geometryClearcoatNormal, const in PhysicalMaterial material, inout ReflectedLight reflectedLight ) {
	vec3 singleScattering = vec3( 0.0 );
	vec3 multiScattering = vec3( 0.0 );
	#ifdef USE_IRIDESCENCE
		computeMultiscatteringIridescence( material.dfg, material.specularColor, material.specularF90, material.iridescence, material.iridescenceF0Dielectric, singleScattering, multiScattering );
	#else
		computeMultiscattering( material.dfg, material.specularColor, material.specularF90, singleScattering, multiScattering );
	#endif
	#ifdef USE_DIFFUSE_ROUGHNESS
		float dotNV = saturate( dot( geometryNormal, geometryViewDir ) );
		vec3 diffuseAlbedo = EON_DirectionalAlbedo( material.diffuseColor, material.diffuseRoughness, dotNV ) * ( 1.0 - material.metalness );
		vec3 diffuse = irradiance * RECIPROCAL_PI * diffuseAlbedo * ( 1.0 - singleScattering - multiScattering );
	#else
		vec3 diffuse = irradiance * BRDF_Lambert( material.diffuseContribution ) * ( 1.0 - singleScattering - multiScattering );
	#endif
	#ifdef USE_SHEEN
		float sheenAlbedo = IBLSheenBRDF( geometryNormal, geometryViewDir, material.sheenRoughness );
		sheenSpecularIndirect += irradiance * material.sheenColor * sheenAlbedo * RECIPROCAL_PI;
		float sheenEnergyComp = 1.0 - max3( material.sheenColor ) * sheenAlbedo;
		diffuse *= sheenEnergyComp;
	#endif
	reflectedLight.indirectDiffuse += diffuse;
}
void RE_IndirectSpecular_Physical( const in vec3 radiance, const in vec3 irradiance, const in vec3 clearcoatRadiance, const in vec3 geometryPosition, const in vec3 geometryNormal, const in vec3 geometryViewDir, const in vec3 geometryClearcoatNormal, const in PhysicalMaterial material, inout ReflectedLight reflectedLight) {
	#ifdef USE_CLEARCOAT
		clearcoatSpecularIndirect += clearcoatRadiance * EnvironmentBRDF( geometryClearcoatNormal, geometryViewDir, material.clearcoatF0, material.clearcoatF90, material.clearcoatRoughness );
	#endif
	#ifdef USE_SHEEN
		sheenSpecularIndirect += irradiance * material.sheenColor * IBLSheenBRDF( geometryNormal, geometryViewDir, material.sheenRoughness ) * RECIPROCAL_PI;
 	#endif
	vec3 singleScatteringDielectric = vec3( 0.0 );
	vec3 multiScatteringDielectric = vec3( 0.0 );
	vec3 singleScatteringMetallic = vec3( 0.0 );
	vec3 multiScatteringMetallic = vec3( 0.0 );
	#ifdef USE_IRIDESCENCE
		computeMultiscatteringIridescence( material.dfg, material.specularColor, material.specularF90, material.iridescence, material.iridescenceF0Dielectric, singleScatteringDielectric, multiScatteringDielectric );
		computeMultiscatteringIridescence( material.dfg, material.diffuseColor, material.specularF90, material.iridescence, material.iridescenceF0Metallic, singleScatteringMetallic, multiScatteringMetallic );
	#else
		computeMultiscattering( material.dfg, material.specularColor, material.specularF90, singleScatteringDielectric, multiScatteringDielectric );
		computeMultiscattering( material.dfg, material.diffuseColor, material.specularF90, singleScatteringMetallic, multiScatteringMetallic );
	#endif
	vec3 singleScattering = mix( singleScatteringDielectric, singleScatteringMetallic, material.metalness );
	vec3 multiScattering = mix( multiScatteringDielectric, multiScatteringMetallic, material.metalness );
	vec3 totalScatteringDielectric = singleScatteringDielectric + multiScatteringDielectric;
	#ifdef USE_DIFFUSE_ROUGHNESS
		float dotNV = saturate( dot( geometryNormal, geometryViewDir ) );
		vec3 diffuse = EON_DirectionalAlbedo( material.diffuseColor, material.diffuseRoughness, dotNV ) * ( 1.0 - material.metalness ) * ( 1.0 - totalScatteringDielectric );
	#else
		vec3 diffuse = material.diffuseContribution * ( 1.0 - totalScatteringDielectric );
	#endif
	vec3 cosineWeightedIrradiance = irradiance * RECIPROCAL_PI;
	vec3 indirectSpecular = radiance * singleScattering;
	indirectSpecular += multiScattering * cosineWeightedIrradiance;
	vec3 indirectDiffuse = diffuse * cosineWeightedIrradiance;
	#ifdef USE_SHEEN
		float sheenAlbedo = IBLSheenBRDF( geometryNormal, geometryViewDir, material.sheenRoughness );
		float sheenEnergyComp = 1.0 - max3( material.sheenColor ) * sheenAlbedo;
		indirectSpecular *= sheenEnergyComp;
		indirectDiffuse *= sheenEnergyComp;
	#endif
	reflectedLight.indirectSpecular += indirectSpecular;
	reflectedLight.indirectDiffuse += indirectDiffuse;
}
#define RE_Direct				RE_Direct_Physical
#define RE_Direct_RectArea		RE_Direct_RectArea_Physical
#define RE_IndirectDiffuse		RE_IndirectDiffuse_Physical
#define RE_IndirectSpecular		RE_IndirectSpecular_Physical
float computeSpecularOcclusion( const in float dotNV, const in float ambientOcclusion, const in float roughness ) {
	return saturate( pow( dotNV + ambientOcclusion, exp2( - 16.0 * roughness - 1.0 ) ) - 1.0 + ambientOcclusion );
}`,dh=`
vec3 geometryPosition = - vViewPosition;
vec3 geometryNormal = normal;
vec3 geometryViewDir = ( isOrthographic ) ? vec3( 0, 0, 1 ) : normalize( vViewPosition );
vec3 geometryClearcoatNormal = vec3( 0.0 );
#ifdef USE_CLEARCOAT
	geometryClearcoatNormal = clearcoatNormal;
#endif
#ifdef USE_IRIDESCENCE
	float dotNVi = saturate( dot( normal, geometryViewDir ) );
	if ( material.iridescenceThickness == 0.0 ) {
		material.iridescence = 0.0;
	} else {
		material.iridescence = saturate( material.iridescence );
	}
	if ( material.iridescence > 0.0 ) {
		vec3 iridescenceFresnelDielectric = evalIridescence( 1.0, material.iridescenceIOR, dotNVi, material.iridescenceThickness, material.specularColor );
		vec3 iridescenceFresnelMetallic = evalIridescence( 1.0, material.iridescenceIOR, dotNVi, material.iridescenceThickness, material.diffuseColor );
		material.iridescenceFresnel = mix( iridescenceFresnelDielectric, iridescenceFresnelMetallic, material.metalness );
		material.iridescenceF0Dielectric = Schlick_to_F0( iridescenceFresnelDielectric, 1.0, dotNVi );
		material.iridescenceF0Metallic = Schlick_to_F0( iridescenceFresnelMetallic, 1.0, dotNVi );
	}
#endif
#ifdef STANDARD
	float dotNVms = saturate( dot( geometryNormal, geometryViewDir ) );
	material.dfg = texture2D( dfgLUT, vec2( material.roughness, dotNVms ) ).rg;
	#if ( NUM_SUN_LIGHTS > 0 || NUM_DIR_LIGHTS > 0 || NUM_POINT_LIGHTS > 0 || NUM_SPOT_LIGHTS > 0 )
		float EssMs = material.dfg.x + material.dfg.y;
		material.multiScatteringCompensation = 1.0 + material.specularColorBlended * ( 1.0 / EssMs - 1.0 );
	#endif
#endif
IncidentLight directLight;
#if ( NUM_POINT_LIGHTS > 0 ) && defined( RE_Direct )
	PointLight pointLight;
	#if defined( USE_SHADOWMAP ) && NUM_POINT_LIGHT_SHADOWS > 0
	PointLightShadow pointLightShadow;
	#endif
	#pragma unroll_loop_start
	for ( int i = 0; i < NUM_POINT_LIGHTS; i ++ ) {
		pointLight = pointLights[ i ];
		getPointLightInfo( pointLight, geometryPosition, directLight );
		#if defined( USE_SHADOWMAP ) && ( UNROLLED_LOOP_INDEX < NUM_POINT_LIGHT_SHADOWS ) && ( defined( SHADOWMAP_TYPE_PCF ) || defined( SHADOWMAP_TYPE_BASIC ) )
		pointLightShadow = pointLightShadows[ i ];
		directLight.color *= ( directLight.visible && receiveShadow ) ? getPointShadow( pointShadowMap[ i ], pointLightShadow.shadowMapSize, pointLightShadow.shadowIntensity, pointLightShadow.shadowBias, pointLightShadow.shadowRadius, vPointShadowCoord[ i ], pointLightShadow.shadowCameraNear, pointLightShadow.shadowCameraFar ) : 1.0;
		#endif
		RE_Direct( directLight, geometryPosition, geometryNormal, geometryViewDir, geometryClearcoatNormal, material, reflectedLight );
	}
	#pragma unroll_loop_end
#endif
#if ( NUM_SPOT_LIGHTS > 0 ) && defined( RE_Direct )
	SpotLight spotLight;
	vec4 spotColor;
	vec3 spotLightCoord;
	bool inSpotLightMap;
	#if defined( USE_SHADOWMAP ) && NUM_SPOT_LIGHT_SHADOWS > 0
	SpotLightShadow spotLightShadow;
	#endif
	#pragma unroll_loop_start
	for ( int i = 0; i < NUM_SPOT_LIGHTS; i ++ ) {
		spotLight = spotLights[ i ];
		getSpotLightInfo( spotLight, geometryPosition, directLight );
		#if ( UNROLLED_LOOP_INDEX < NUM_SPOT_LIGHT_SHADOWS_WITH_MAPS )
		#define SPOT_LIGHT_MAP_INDEX UNROLLED_LOOP_INDEX
		#elif ( UNROLLED_LOOP_INDEX < NUM_SPOT_LIGHT_SHADOWS )
		#define SPOT_LIGHT_MAP_INDEX NUM_SPOT_LIGHT_MAPS
		#else
		#define SPOT_LIGHT_MAP_INDEX ( UNROLLED_LOOP_INDEX - NUM_SPOT_LIGHT_SHADOWS + NUM_SPOT_LIGHT_SHADOWS_WITH_MAPS )
		#endif
		#if ( SPOT_LIGHT_MAP_INDEX < NUM_SPOT_LIGHT_MAPS )
			spotLightCoord = vSpotLightCoord[ i ].xyz / vSpotLightCoord[ i ].w;
			inSpotLightMap = all( lessThan( abs( spotLightCoord * 2. - 1. ), vec3( 1.0 ) ) );
			spotColor = texture2D( spotLightMap[ SPOT_LIGHT_MAP_INDEX ], spotLightCoord.xy );
			directLight.color = inSpotLightMap ? directLight.color * spotColor.rgb : directLight.color;
		#endif
		#undef SPOT_LIGHT_MAP_INDEX
		#if defined( USE_SHADOWMAP ) && ( UNROLLED_LOOP_INDEX < NUM_SPOT_LIGHT_SHADOWS )
		spotLightShadow = spotLightShadows[ i ];
		directLight.color *= ( directLight.visible && receiveShadow ) ? getShadow( spotShadowMap[ i ], spotLightShadow.shadowMapSize, spotLightShadow.shadowIntensity, spotLightShadow.shadowBias, spotLightShadow.shadowRadius, vSpotLightCoord[ i ] ) : 1.0;
		#endif
		RE_Direct( directLight, geometryPosition, geometryNormal, geometryViewDir, geometryClearcoatNormal, material, reflectedLight );
	}
	#pragma unroll_loop_end
#endif
#if ( NUM_SUN_LIGHTS > 0 ) && defined( RE_Direct )
	SunLight sunLight;
	#if defined( USE_SHADOWMAP ) && NUM_SUN_LIGHT_SHADOWS > 0
	SunLightShadow sunLightShadow;
	#endif
	#pragma unroll_loop_start
	for ( int i = 0; i < NUM_SUN_LIGHTS; i ++ ) {
		sunLight = sunLights[ i ];
		getSunLightInfo( sunLight, directLight );
		#if defined( USE_SHADOWMAP ) && ( UNROLLED_LOOP_INDEX < NUM_SUN_LIGHT_SHADOWS )
		sunLightShadow = sunLightShadows[ i ];
		directLight.color *= ( directLight.visible && receiveShadow ) ? getSunShadow( sunShadowMap[ i ], sunLightShadow, UNROLLED_LOOP_INDEX ) : 1.0;
		#endif
		RE_Direct( directLight, geometryPosition, geometryNormal, geometryViewDir, geometryClearcoatNormal, material, reflectedLight );
	}
	#pragma unroll_loop_end
#endif
#if ( NUM_DIR_LIGHTS > 0 ) && defined( RE_Direct )
	DirectionalLight directionalLight;
	#if defined( USE_SHADOWMAP ) && NUM_DIR_LIGHT_SHADOWS > 0
	DirectionalLightShadow directionalLightShadow;
	#endif
	#pragma unroll_loop_start
	for ( int i = 0; i < NUM_DIR_LIGHTS; i ++ ) {
		directionalLight = directionalLights[ i ];
		getDirectionalLightInfo( directionalLight, directLight );
		#if defined( USE_SHADOWMAP ) && ( UNROLLED_LOOP_INDEX < NUM_DIR_LIGHT_SHADOWS )
		directionalLightShadow = directionalLightShadows[ i ];
		directLight.color *= ( directLight.visible && receiveShadow ) ? getShadow( directionalShadowMap[ i ], directionalLightShadow.shadowMapSize, directionalLightShadow.shadowIntensity, directionalLightShadow.shadowBias, directionalLightShadow.shadowRadius, vDirectionalShadowCoord[ i ] ) : 1.0;
		#endif
		RE_Direct( directLight, geometryPosition, geometryNormal, geometryViewDir, geometryClearcoatNormal, material, reflectedLight );
	}
	#pragma unroll_loop_end
#endif
#if ( NUM_RECT_AREA_LIGHTS > 0 ) && defined( RE_Direct_RectArea )
	RectAreaLight rectAreaLight;
	#pragma unroll_loop_start
	for ( int i = 0; i < NUM_RECT_AREA_LIGHTS; i ++ ) {
		rectAreaLight = rectAreaLights[ i ];
		RE_Direct_RectArea( rectAreaLight, geometryPosition, geometryNormal, geometryViewDir, geometryClearcoatNormal, material, reflectedLight );
	}
	#pragma unroll_loop_end
#endif
#if defined( RE_IndirectDiffuse )
	vec3 iblIrradiance = vec3( 0.0 );
	vec3 irradiance = getAmbientLightIrradiance( ambientLightColor );
	#if defined( USE_LIGHT_PROBES )
		irradiance += getLightProbeIrradiance( lightProbe, geometryNormal );
	#endif
	#if ( NUM_HEMI_LIGHTS > 0 )
		#pragma unroll_loop_start
		for ( int i = 0; i < NUM_HEMI_LIGHTS; i ++ ) {
			irradiance += getHemisphereLightIrradiance( hemisphereLights[ i ], geometryNormal );
		}
		#pragma unroll_loop_end
	#endif
	#if NUM_LIGHT_PROBE_GRIDS > 0
		vec3 probeWorldPos = ( ( vec4( geometryPosition, 1.0 ) - viewMatrix[ 3 ] ) * viewMatrix ).xyz;
		vec3 probeWorldNormal = transformNormalByInverseViewMatrix( geometryNormal, viewMatrix );
		int probeGrid = - 1;
		#pragma unroll_loop_start
		for ( int i = 0; i < NUM_LIGHT_PROBE_GRIDS; i ++ ) {
			if ( isInsideLightProbeGrid( probeWorldPos, probeWorldNormal, probesMin[ i ], probesMax[ i ], probesResolution[ i ] ) ) probeGrid = UNROLLED_LOOP_INDEX;
		}
		#pragma unroll_loop_end
		#pragma unroll_loop_start
		for ( int i = 0; i < NUM_LIGHT_PROBE_GRIDS; i ++ ) {
			if ( probeGrid == UNROLLED_LOOP_INDEX ) irradiance += getLightProbeGridIrradiance( probesSH[ i ], probesMin[ i ], probesMax[ i ], probesResolution[ i ], probeWorldPos, probeWorldNormal );
		}
		#pragma unroll_loop_end
	#endif
#endif
#if defined( RE_IndirectSpecular )
	vec3 radiance = vec3( 0.0 );
	vec3 clearcoatRadiance = vec3( 0.0 );
#endif`,uh=`#if defined( RE_IndirectDiffuse )
	#ifdef USE_LIGHTMAP
		vec4 lightMapTexel = texture2D( lightMap, vLightMapUv );
		vec3 lightMapIrradiance = lightMapTexel.rgb * lightMapIntensity;
		irradiance += lightMapIrradiance;
	#endif
	#if defined( USE_ENVMAP ) && defined( ENVMAP_TYPE_PMREM )
		#if defined( STANDARD ) || defined( LAMBERT ) || defined( PHONG )
			iblIrradiance += getIBLIrradiance( geometryNormal );
		#endif
	#endif
#endif
#if defined( USE_ENVMAP ) && defined( RE_IndirectSpecular )
	#ifdef USE_ANISOTROPY
		vec3 iblRadiance = getIBLAnisotropyRadiance( geometryViewDir, geometryNormal, material.roughness, material.anisotropyB, material.anisotropy );
	#else
		vec3 iblRadiance = getIBLRadiance( geometryViewDir, geometryNormal, material.roughness );
	#endif
	#ifdef USE_RETROREFLECTION
		#ifdef USE_ANISOTROPY
			vec3 retroIBLRadiance = getIBLAnisotropyRetroRadiance( geometryViewDir, geometryNormal, material.roughness, material.anisotropyB, material.anisotropy );
		#else
			vec3 retroIBLRadiance = getIBLRetroRadiance( geometryViewDir, geometryNormal, material.roughness );
		#endif
		iblRadiance = mix( iblRadiance, retroIBLRadiance, saturate( material.retroreflectivity ) );
	#endif
	radiance += iblRadiance;
	#ifdef USE_CLEARCOAT
		clearcoatRadiance += getIBLRadiance( geometryViewDir, geometryClearcoatNormal, material.clearcoatRoughness );
	#endif
#endif`,fh=`#if defined( RE_IndirectDiffuse )
	#if defined( LAMBERT ) || defined( PHONG )
		irradiance += iblIrradiance;
	#endif
	RE_IndirectDiffuse( irradiance, geometryPosition, geometryNormal, geometryViewDir, geometryClearcoatNormal, material, reflectedLight );
#endif
#if defined( RE_IndirectSpecular )
	RE_IndirectSpecular( radiance, iblIrradiance, clearcoatRadiance, geometryPosition, geometryNormal, geometryViewDir, geometryClearcoatNormal, material, reflectedLight );
#endif`,ph=`#if NUM_LIGHT_PROBE_GRIDS > 0
uniform highp sampler3D probesSH[ NUM_LIGHT_PROBE_GRIDS ];
uniform vec3 probesMin[ NUM_LIGHT_PROBE_GRIDS ];
uniform vec3 probesMax[ NUM_LIGHT_PROBE_GRIDS ];
uniform vec3 probesResolution[ NUM_LIGHT_PROBE_GRIDS ];
bool isInsideLightProbeGrid( vec3 worldPos, vec3 worldNormal, vec3 probesMin, vec3 probesMax, vec3 probesResolution ) {
	vec3 spacing = ( probesMax - probesMin ) / probesResolution;
	vec3 samplePos = worldPos + worldNormal * spacing * 0.5;
	vec3 margin = spacing * 0.01;
	return all( greaterThanEqual( samplePos, probesMin - margin ) ) && all( lessThanEqual( samplePos, probesMax + margin ) );
}
vec3 getLightProbeGridIrradiance( highp sampler3D probesSH, vec3 probesMin, vec3 probesMax, vec3 probesResolution, vec3 worldPos, vec3 worldNormal ) {
	vec3 res = probesResolution;
	vec3 gridRange = probesMax - probesMin;
	vec3 probeSpacing = gridRange / res;
	vec3 samplePos = worldPos + worldNormal * probeSpacing * 0.5;
	vec3 uvw = clamp( ( samplePos - probesMin ) / gridRange, 0.5 / res, 1.0 - 0.5 / res );
	float nz          = res.z;
	float paddedSlices = nz + 2.0;
	float atlasDepth  = 7.0 * paddedSlices;
	float uvZBase     = uvw.z * nz + 1.0;
	vec4 s0 = texture( probesSH, vec3( uvw.xy, ( uvZBase                       ) / atlasDepth ) );
	vec4 s1 = texture( probesSH, vec3( uvw.xy, ( uvZBase +       paddedSlices   ) / atlasDepth ) );
	vec4 s2 = texture( probesSH, vec3( uvw.xy, ( uvZBase + 2.0 * paddedSlices   ) / atlasDepth ) );
	vec4 s3 = texture( probesSH, vec3( uvw.xy, ( uvZBase + 3.0 * paddedSlices   ) / atlasDepth ) );
	vec4 s4 = texture( probesSH, vec3( uvw.xy, ( uvZBase + 4.0 * paddedSlices   ) / atlasDepth ) );
	vec4 s5 = texture( probesSH, vec3( uvw.xy, ( uvZBase + 5.0 * paddedSlices   ) / atlasDepth ) );
	vec4 s6 = texture( probesSH, vec3( uvw.xy, ( uvZBase + 6.0 * paddedSlices   ) / atlasDepth ) );
	vec3 c0 = s0.xyz;
	vec3 c1 = vec3( s0.w, s1.xy );
	vec3 c2 = vec3( s1.zw, s2.x );
	vec3 c3 = s2.yzw;
	vec3 c4 = s3.xyz;
	vec3 c5 = vec3( s3.w, s4.xy );
	vec3 c6 = vec3( s4.zw, s5.x );
	vec3 c7 = s5.yzw;
	vec3 c8 = s6.xyz;
	float x = worldNormal.x, y = worldNormal.y, z = worldNormal.z;
	vec3 result = c0 * 0.886227;
	result += c1 * 2.0 * 0.511664 * y;
	result += c2 * 2.0 * 0.511664 * z;
	result += c3 * 2.0 * 0.511664 * x;
	result += c4 * 2.0 * 0.429043 * x * y;
	result += c5 * 2.0 * 0.429043 * y * z;
	result += c6 * ( 0.743125 * z * z - 0.247708 );
	result += c7 * 2.0 * 0.429043 * x * z;
	result += c8 * 0.429043 * ( x * x - y * y );
	return max( result, vec3( 0.0 ) );
}
#endif`,mh=`#if defined( USE_LOGARITHMIC_DEPTH_BUFFER )
	gl_FragDepth = vIsPerspective == 0.0 ? gl_FragCoord.z : log2( vFragDepth ) * logDepthBufFC * 0.5;
#endif`,gh=`#if defined( USE_LOGARITHMIC_DEPTH_BUFFER )
	uniform float logDepthBufFC;
	varying float vFragDepth;
	varying float vIsPerspective;
#endif`,_h=`#ifdef USE_LOGARITHMIC_DEPTH_BUFFER
	varying float vFragDepth;
	varying float vIsPerspective;
#endif`,vh=`#ifdef USE_LOGARITHMIC_DEPTH_BUFFER
	vFragDepth = 1.0 + gl_Position.w;
	vIsPerspective = float( isPerspectiveMatrix( projectionMatrix ) );
#endif`,xh=`#ifdef USE_MAP
	vec4 sampledDiffuseColor = texture2D( map, vMapUv );
	#ifdef DECODE_VIDEO_TEXTURE
		sampledDiffuseColor = sRGBTransferEOTF( sampledDiffuseColor );
	#endif
	diffuseColor *= sampledDiffuseColor;
#endif`,Sh=`#ifdef USE_MAP
	uniform sampler2D map;
#endif`,Mh=`#if defined( USE_MAP ) || defined( USE_ALPHAMAP )
	#if defined( USE_POINTS_UV )
		vec2 uv = vUv;
	#else
		vec2 uv = ( uvTransform * vec3( gl_PointCoord.x, 1.0 - gl_PointCoord.y, 1 ) ).xy;
	#endif
#endif
#ifdef USE_MAP
	diffuseColor *= texture2D( map, uv );
#endif
#ifdef USE_ALPHAMAP
	diffuseColor.a *= texture2D( alphaMap, uv ).g;
#endif`,wh=`#if defined( USE_POINTS_UV )
	varying vec2 vUv;
#else
	#if defined( USE_MAP ) || defined( USE_ALPHAMAP )
		uniform mat3 uvTransform;
	#endif
#endif
#ifdef USE_MAP
	uniform sampler2D map;
#endif
#ifdef USE_ALPHAMAP
	uniform sampler2D alphaMap;
#endif`,yh=`float metalnessFactor = metalness;
#ifdef USE_METALNESSMAP
	vec4 texelMetalness = texture2D( metalnessMap, vMetalnessMapUv );
	metalnessFactor *= texelMetalness.b;
#endif`,bh=`#ifdef USE_METALNESSMAP
	uniform sampler2D metalnessMap;
#endif`,Eh=`#ifdef USE_INSTANCING_MORPH
	float morphTargetInfluences[ MORPHTARGETS_COUNT ];
	float morphTargetBaseInfluence = texelFetch( morphTexture, ivec2( 0, gl_InstanceID ), 0 ).r;
	for ( int i = 0; i < MORPHTARGETS_COUNT; i ++ ) {
		morphTargetInfluences[i] =  texelFetch( morphTexture, ivec2( i + 1, gl_InstanceID ), 0 ).r;
	}
#endif`,Th=`#if defined( USE_MORPHCOLORS )
	#if defined( USE_COLOR_ALPHA )
		vColor *= morphTargetBaseInfluence;
	#elif defined( USE_COLOR )
		vColor.rgb *= morphTargetBaseInfluence;
	#endif
	for ( int i = 0; i < MORPHTARGETS_COUNT; i ++ ) {
		#if defined( USE_COLOR_ALPHA )
			if ( morphTargetInfluences[ i ] != 0.0 ) vColor += getMorph( gl_VertexID, i, 2 ) * morphTargetInfluences[ i ];
		#elif defined( USE_COLOR )
			if ( morphTargetInfluences[ i ] != 0.0 ) vColor.rgb += getMorph( gl_VertexID, i, 2 ).rgb * morphTargetInfluences[ i ];
		#endif
	}
#endif`,Ah=`#ifdef USE_MORPHNORMALS
	objectNormal *= morphTargetBaseInfluence;
	for ( int i = 0; i < MORPHTARGETS_COUNT; i ++ ) {
		if ( morphTargetInfluences[ i ] != 0.0 ) objectNormal += getMorph( gl_VertexID, i, 1 ).xyz * morphTargetInfluences[ i ];
	}
#endif`,Rh=`#ifdef USE_MORPHTARGETS
	#ifndef USE_INSTANCING_MORPH
		uniform float morphTargetBaseInfluence;
		uniform float morphTargetInfluences[ MORPHTARGETS_COUNT ];
	#endif
	uniform sampler2DArray morphTargetsTexture;
	uniform ivec2 morphTargetsTextureSize;
	vec4 getMorph( const in int vertexIndex, const in int morphTargetIndex, const in int offset ) {
		int texelIndex = vertexIndex * MORPHTARGETS_TEXTURE_STRIDE + offset;
		int y = texelIndex / morphTargetsTextureSize.x;
		int x = texelIndex - y * morphTargetsTextureSize.x;
		ivec3 morphUV = ivec3( x, y, morphTargetIndex );
		return texelFetch( morphTargetsTexture, morphUV, 0 );
	}
#endif`,Ch=`#ifdef USE_MORPHTARGETS
	transformed *= morphTargetBaseInfluence;
	for ( int i = 0; i < MORPHTARGETS_COUNT; i ++ ) {
		if ( morphTargetInfluences[ i ] != 0.0 ) transformed += getMorph( gl_VertexID, i, 0 ).xyz * morphTargetInfluences[ i ];
	}
#endif`,Ph=`float faceDirection = gl_FrontFacing ? 1.0 : - 1.0;
#ifdef FLAT_SHADED
	vec3 fdx = dFdx( vViewPosition );
	vec3 fdy = dFdy( vViewPosition );
	vec3 normal = normalize( cross( fdx, fdy ) );
#else
	vec3 normal = normalize( vNormal );
	#ifdef DOUBLE_SIDED
		normal *= faceDirection;
	#endif
#endif
#if defined( USE_NORMALMAP_TANGENTSPACE ) || defined( USE_CLEARCOAT_NORMALMAP ) || defined( USE_ANISOTROPY )
	#ifdef USE_TANGENT
		mat3 tbn = mat3( normalize( vTangent ), normalize( vBitangent ), normal );
	#else
		mat3 tbn = getTangentFrame( - vViewPosition, normal,
		#if defined( USE_NORMALMAP )
			vNormalMapUv
		#elif defined( USE_CLEARCOAT_NORMALMAP )
			vClearcoatNormalMapUv
		#else
			vUv
		#endif
		);
	#endif
	#ifdef DOUBLE_SIDED
		tbn[0] *= faceDirection;
		tbn[1] *= faceDirection;
	#endif
#endif
#ifdef USE_CLEARCOAT_NORMALMAP
	#ifdef USE_TANGENT
		mat3 tbn2 = mat3( normalize( vTangent ), normalize( vBitangent ), normal );
	#else
		mat3 tbn2 = getTangentFrame( - vViewPosition, normal, vClearcoatNormalMapUv );
	#endif
	#ifdef DOUBLE_SIDED
		tbn2[0] *= faceDirection;
		tbn2[1] *= faceDirection;
	#endif
#endif
vec3 nonPerturbedNormal = normal;`,Lh=`#ifdef USE_NORMALMAP_OBJECTSPACE
	normal = texture2D( normalMap, vNormalMapUv ).xyz * 2.0 - 1.0;
	#ifdef FLIP_SIDED
		normal = - normal;
	#endif
	#ifdef DOUBLE_SIDED
		normal = normal * faceDirection;
	#endif
	normal = normalize( normalMatrix * normal );
#elif defined( USE_NORMALMAP_TANGENTSPACE )
	vec3 mapN = texture2D( normalMap, vNormalMapUv ).xyz * 2.0 - 1.0;
	#if defined( USE_PACKED_NORMALMAP )
		mapN = vec3( mapN.xy, sqrt( saturate( 1.0 - dot( mapN.xy, mapN.xy ) ) ) );
	#endif
	mapN.xy *= normalScale;
	normal = normalize( tbn * mapN );
#elif defined( USE_BUMPMAP )
	normal = perturbNormalArb( - vViewPosition, normal, dHdxy_fwd(), faceDirection );
#endif`,Dh=`#ifndef FLAT_SHADED
	varying vec3 vNormal;
	#ifdef USE_TANGENT
		varying vec3 vTangent;
		varying vec3 vBitangent;
	#endif
#endif`,Nh=`#ifndef FLAT_SHADED
	varying vec3 vNormal;
	#ifdef USE_TANGENT
		varying vec3 vTangent;
		varying vec3 vBitangent;
	#endif
#endif`,Fh=`#ifndef FLAT_SHADED
	vNormal = normalize( transformedNormal );
	#ifdef USE_TANGENT
		vTangent = normalize( transformedTangent );
		vBitangent = normalize( cross( vNormal, vTangent ) * tangent.w );
		#ifdef FLIP_SIDED
			vBitangent = - vBitangent;
		#endif
	#endif
#endif`,Ih=`#ifdef USE_NORMALMAP
	uniform sampler2D normalMap;
	uniform vec2 normalScale;
#endif
#ifdef USE_NORMALMAP_OBJECTSPACE
	uniform mat3 normalMatrix;
#endif
#if ! defined ( USE_TANGENT ) && ( defined ( USE_NORMALMAP_TANGENTSPACE ) || defined ( USE_CLEARCOAT_NORMALMAP ) || defined( USE_ANISOTROPY ) )
	mat3 getTangentFrame( vec3 eye_pos, vec3 surf_norm, vec2 uv ) {
		vec3 q0 = dFdx( eye_pos.xyz );
		vec3 q1 = dFdy( eye_pos.xyz );
		vec2 st0 = dFdx( uv.st );
		vec2 st1 = dFdy( uv.st );
		vec3 N = surf_norm;
		vec3 q1perp = cross( q1, N );
		vec3 q0perp = cross( N, q0 );
		vec3 T = q1perp * st0.x + q0perp * st1.x;
		vec3 B = q1perp * st0.y + q0perp * st1.y;
		float det = max( dot( T, T ), dot( B, B ) );
		float scale = ( det == 0.0 ) ? 0.0 : inversesqrt( det );
		return mat3( T * scale, B * scale, N );
	}
#endif`,Uh=`#ifdef USE_CLEARCOAT
	vec3 clearcoatNormal = nonPerturbedNormal;
#endif`,Oh=`#ifdef USE_CLEARCOAT_NORMALMAP
	vec3 clearcoatMapN = texture2D( clearcoatNormalMap, vClearcoatNormalMapUv ).xyz * 2.0 - 1.0;
	clearcoatMapN.xy *= clearcoatNormalScale;
	clearcoatNormal = normalize( tbn2 * clearcoatMapN );
#endif`,Bh=`#ifdef USE_CLEARCOATMAP
	uniform sampler2D clearcoatMap;
#endif
#ifdef USE_CLEARCOAT_NORMALMAP
	uniform sampler2D clearcoatNormalMap;
	uniform vec2 clearcoatNormalScale;
#endif
#ifdef USE_CLEARCOAT_ROUGHNESSMAP
	uniform sampler2D clearcoatRoughnessMap;
#endif`,kh=`#ifdef USE_IRIDESCENCEMAP
	uniform sampler2D iridescenceMap;
#endif
#ifdef USE_IRIDESCENCE_THICKNESSMAP
	uniform sampler2D iridescenceThicknessMap;
#endif`,Gh=`#ifdef OPAQUE
diffuseColor.a = 1.0;
#endif
#ifdef USE_TRANSMISSION
diffuseColor.a *= material.transmissionAlpha;
#endif
gl_FragColor = vec4( outgoingLight, diffuseColor.a );`,zh=`vec3 packNormalToRGB( const in vec3 normal ) {
	return normalize( normal ) * 0.5 + 0.5;
}
vec3 unpackRGBToNormal( const in vec3 rgb ) {
	return 2.0 * rgb.xyz - 1.0;
}
const float PackUpscale = 256. / 255.;const float UnpackDownscale = 255. / 256.;const float ShiftRight8 = 1. / 256.;
const float Inv255 = 1. / 255.;
const vec4 PackFactors = vec4( 1.0, 256.0, 256.0 * 256.0, 256.0 * 256.0 * 256.0 );
const vec2 UnpackFactors2 = vec2( UnpackDownscale, 1.0 / PackFactors.g );
const vec3 UnpackFactors3 = vec3( UnpackDownscale / PackFactors.rg, 1.0 / PackFactors.b );
const vec4 UnpackFactors4 = vec4( UnpackDownscale / PackFactors.rgb, 1.0 / PackFactors.a );
vec4 packDepthToRGBA( const in float v ) {
	if( v <= 0.0 )
		return vec4( 0., 0., 0., 0. );
	if( v >= 1.0 )
		return vec4( 1., 1., 1., 1. );
	float vuf;
	float af = modf( v * PackFactors.a, vuf );
	float bf = modf( vuf * ShiftRight8, vuf );
	float gf = modf( vuf * ShiftRight8, vuf );
	return vec4( vuf * Inv255, gf * PackUpscale, bf * PackUpscale, af );
}
vec3 packDepthToRGB( const in float v ) {
	if( v <= 0.0 )
		return vec3( 0., 0., 0. );
	if( v >= 1.0 )
		return vec3( 1., 1., 1. );
	float vuf;
	float bf = modf( v * PackFactors.b, vuf );
	float gf = modf( vuf * ShiftRight8, vuf );
	return vec3( vuf * Inv255, gf * PackUpscale, bf );
}
vec2 packDepthToRG( const in float v ) {
	if( v <= 0.0 )
		return vec2( 0., 0. );
	if( v >= 1.0 )
		return vec2( 1., 1. );
	float vuf;
	float gf = modf( v * 256., vuf );
	return vec2( vuf * Inv255, gf );
}
float unpackRGBAToDepth( const in vec4 v ) {
	return dot( v, UnpackFactors4 );
}
float unpackRGBToDepth( const in vec3 v ) {
	return dot( v, UnpackFactors3 );
}
float unpackRGToDepth( const in vec2 v ) {
	return v.r * UnpackFactors2.r + v.g * UnpackFactors2.g;
}
vec4 pack2HalfToRGBA( const in vec2 v ) {
	vec4 r = vec4( v.x, fract( v.x * 255.0 ), v.y, fract( v.y * 255.0 ) );
	return vec4( r.x - r.y / 255.0, r.y, r.z - r.w / 255.0, r.w );
}
vec2 unpackRGBATo2Half( const in vec4 v ) {
	return vec2( v.x + ( v.y / 255.0 ), v.z + ( v.w / 255.0 ) );
}
float viewZToOrthographicDepth( const in float viewZ, const in float near, const in float far ) {
	return ( viewZ + near ) / ( near - far );
}
float orthographicDepthToViewZ( const in float depth, const in float near, const in float far ) {
	#ifdef USE_REVERSED_DEPTH_BUFFER
	
		return depth * ( far - near ) - far;
	#else
		return depth * ( near - far ) - near;
	#endif
}
float viewZToPerspectiveDepth( const in float viewZ, const in float near, const in float far ) {
	return ( ( near + viewZ ) * far ) / ( ( far - near ) * viewZ );
}
float perspectiveDepthToViewZ( const in float depth, const in float near, const in float far ) {
	
	#ifdef USE_REVERSED_DEPTH_BUFFER
		return ( near * far ) / ( ( near - far ) * depth - near );
	#else
		return ( near * far ) / ( ( far - near ) * depth - far );
	#endif
}`,Hh=`#ifdef PREMULTIPLIED_ALPHA
	gl_FragColor.rgb *= gl_FragColor.a;
#endif`,Vh=`vec4 mvPosition = vec4( transformed, 1.0 );
#ifdef USE_BATCHING
	mvPosition = batchingMatrix * mvPosition;
#endif
#ifdef USE_INSTANCING
	mvPosition = instanceMatrix * mvPosition;
#endif
mvPosition = modelViewMatrix * mvPosition;
gl_Position = projectionMatrix * mvPosition;`,Wh=`#ifdef DITHERING
	gl_FragColor.rgb = dithering( gl_FragColor.rgb );
#endif`,Xh=`#ifdef DITHERING
	vec3 dithering( vec3 color ) {
		float grid_position = rand( gl_FragCoord.xy );
		vec3 dither_shift_RGB = vec3( 0.25 / 255.0, -0.25 / 255.0, 0.25 / 255.0 );
		dither_shift_RGB = mix( 2.0 * dither_shift_RGB, -2.0 * dither_shift_RGB, grid_position );
		return color + dither_shift_RGB;
	}
#endif`,$h=`float roughnessFactor = roughness;
#ifdef USE_ROUGHNESSMAP
	vec4 texelRoughness = texture2D( roughnessMap, vRoughnessMapUv );
	roughnessFactor *= texelRoughness.g;
#endif`,qh=`#ifdef USE_ROUGHNESSMAP
	uniform sampler2D roughnessMap;
#endif`,Yh=`#if NUM_SPOT_LIGHT_COORDS > 0
	varying vec4 vSpotLightCoord[ NUM_SPOT_LIGHT_COORDS ];
#endif
#if NUM_SPOT_LIGHT_MAPS > 0
	uniform sampler2D spotLightMap[ NUM_SPOT_LIGHT_MAPS ];
#endif
#ifdef USE_SHADOWMAP
	#if NUM_SUN_LIGHT_SHADOWS > 0
		#define SUN_LIGHT_CASCADES 2
		#if defined( SHADOWMAP_TYPE_PCF )
			uniform sampler2DShadow sunShadowMap[ NUM_SUN_LIGHT_SHADOWS ];
		#else
			uniform sampler2D sunShadowMap[ NUM_SUN_LIGHT_SHADOWS ];
		#endif
		uniform mat4 sunShadowMatrix[ NUM_SUN_LIGHT_SHADOWS * SUN_LIGHT_CASCADES ];
		uniform vec4 sunShadowCascade[ NUM_SUN_LIGHT_SHADOWS * SUN_LIGHT_CASCADES ];
		varying vec4 vSunShadowWorldPosition;
		varying vec3 vSunShadowWorldNormal;
		struct SunLightShadow {
			float shadowIntensity;
			float shadowBias;
			float shadowNormalBias;
			float shadowRadius;
			vec2 shadowMapSize;
		};
		uniform SunLightShadow sunLightShadows[ NUM_SUN_LIGHT_SHADOWS ];
	#endif
	#if NUM_DIR_LIGHT_SHADOWS > 0
		#if defined( SHADOWMAP_TYPE_PCF )
			uniform sampler2DShadow directionalShadowMap[ NUM_DIR_LIGHT_SHADOWS ];
		#else
			uniform sampler2D directionalShadowMap[ NUM_DIR_LIGHT_SHADOWS ];
		#endif
		varying vec4 vDirectionalShadowCoord[ NUM_DIR_LIGHT_SHADOWS ];
		struct DirectionalLightShadow {
			float shadowIntensity;
			float shadowBias;
			float shadowNormalBias;
			float shadowRadius;
			vec2 shadowMapSize;
		};
		uniform DirectionalLightShadow directionalLightShadows[ NUM_DIR_LIGHT_SHADOWS ];
	#endif
	#if NUM_SPOT_LIGHT_SHADOWS > 0
		#if defined( SHADOWMAP_TYPE_PCF )
			uniform sampler2DShadow spotShadowMap[ NUM_SPOT_LIGHT_SHADOWS ];
		#else
			uniform sampler2D spotShadowMap[ NUM_SPOT_LIGHT_SHADOWS ];
		#endif
		struct SpotLightShadow {
			float shadowIntensity;
			float shadowBias;
			float shadowNormalBias;
			float shadowRadius;
			vec2 shadowMapSize;
		};
		uniform SpotLightShadow spotLightShadows[ NUM_SPOT_LIGHT_SHADOWS ];
	#endif
	#if NUM_POINT_LIGHT_SHADOWS > 0
		#if defined( SHADOWMAP_TYPE_PCF )
			uniform samplerCubeShadow pointShadowMap[ NUM_POINT_LIGHT_SHADOWS ];
		#elif defined( SHADOWMAP_TYPE_BASIC )
			uniform samplerCube pointShadowMap[ NUM_POINT_LIGHT_SHADOWS ];
		#endif
		varying vec4 vPointShadowCoord[ NUM_POINT_LIGHT_SHADOWS ];
		struct PointLightShadow {
			float shadowIntensity;
			float shadowBias;
			float shadowNormalBias;
			float shadowRadius;
			vec2 shadowMapSize;
			float shadowCameraNear;
			float shadowCameraFar;
		};
		uniform PointLightShadow pointLightShadows[ NUM_POINT_LIGHT_SHADOWS ];
	#endif
	#if defined( SHADOWMAP_TYPE_PCF )
		float interleavedGradientNoise( vec2 position ) {
			return fract( 52.9829189 * fract( dot( position, vec2( 0.06711056, 0.00583715 ) ) ) );
		}
		vec2 vogelDiskSample( int sampleIndex, int samplesCount, float phi ) {
			const float goldenAngle = 2.399963229728653;
			float r = sqrt( ( float( sampleIndex ) + 0.5 ) / float( samplesCount ) );
			float theta = float( sampleIndex ) * goldenAngle + phi;
			return vec2( cos( theta ), sin( theta ) ) * r;
		}
	#endif
	#if defined( SHADOWMAP_TYPE_PCF )
		float getShadow( sampler2DShadow shadowMap, vec2 shadowMapSize, float shadowIntensity, float shadowBias, float shadowRadius, vec4 shadowCoord ) {
			float shadow = 1.0;
			shadowCoord.xyz /= shadowCoord.w;
			#ifdef USE_REVERSED_DEPTH_BUFFER
				shadowCoord.z -= shadowBias;
			#else
				shadowCoord.z += shadowBias;
			#endif
			bool inFrustum = shadowCoord.x >= 0.0 && shadowCoord.x <= 1.0 && shadowCoord.y >= 0.0 && shadowCoord.y <= 1.0;
			bool frustumTest = inFrustum && shadowCoord.z <= 1.0;
			if ( frustumTest ) {
				vec2 texelSize = vec2( 1.0 ) / shadowMapSize;
				vec2 radius = shadowRadius * texelSize;
				float phi = interleavedGradientNoise( gl_FragCoord.xy ) * PI2;
				shadow = (
					texture( shadowMap, vec3( shadowCoord.xy + vogelDiskSample( 0, 5, phi ) * radius, shadowCoord.z ) ) +
					texture( shadowMap, vec3( shadowCoord.xy + vogelDiskSample( 1, 5, phi ) * radius, shadowCoord.z ) ) +
					texture( shadowMap, vec3( shadowCoord.xy + vogelDiskSample( 2, 5, phi ) * radius, shadowCoord.z ) ) +
					texture( shadowMap, vec3( shadowCoord.xy + vogelDiskSample( 3, 5, phi ) * radius, shadowCoord.z ) ) +
					texture( shadowMap, vec3( shadowCoord.xy + vogelDiskSample( 4, 5, phi ) * radius, shadowCoord.z ) )
				) * 0.2;
			}
			return mix( 1.0, shadow, shadowIntensity );
		}
	#elif defined( SHADOWMAP_TYPE_VSM )
		float getShadow( sampler2D shadowMap, vec2 shadowMapSize, float shadowIntensity, float shadowBias, float shadowRadius, vec4 shadowCoord ) {
			float shadow = 1.0;
			shadowCoord.xyz /= shadowCoord.w;
			#ifdef USE_REVERSED_DEPTH_BUFFER
				shadowCoord.z -= shadowBias;
			#else
				shadowCoord.z += shadowBias;
			#endif
			bool inFrustum = shadowCoord.x >= 0.0 && shadowCoord.x <= 1.0 && shadowCoord.y >= 0.0 && shadowCoord.y <= 1.0;
			bool frustumTest = inFrustum && shadowCoord.z <= 1.0;
			if ( frustumTest ) {
				vec2 distribution = texture2D( shadowMap, shadowCoord.xy ).rg;
				float mean = distribution.x;
				float variance = distribution.y * distribution.y;
				#ifdef USE_REVERSED_DEPTH_BUFFER
					float hard_shadow = step( mean, shadowCoord.z );
				#else
					float hard_shadow = step( shadowCoord.z, mean );
				#endif
				
				if ( hard_shadow == 1.0 ) {
					shadow = 1.0;
				} else {
					variance = max( variance, 0.0000001 );
					float d = shadowCoord.z - mean;
					float p_max = variance / ( variance + d * d );
					p_max = clamp( ( p_max - 0.3 ) / 0.65, 0.0, 1.0 );
					shadow = max( hard_shadow, p_max );
				}
			}
			return mix( 1.0, shadow, shadowIntensity );
		}
	#else
		float getShadow( sampler2D shadowMap, vec2 shadowMapSize, float shadowIntensity, float shadowBias, float shadowRadius, vec4 shadowCoord ) {
			float shadow = 1.0;
			shadowCoord.xyz /= shadowCoord.w;
			#ifdef USE_REVERSED_DEPTH_BUFFER
				shadowCoord.z -= shadowBias;
			#else
				shadowCoord.z += shadowBias;
			#endif
			bool inFrustum = shadowCoord.x >= 0.0 && shadowCoord.x <= 1.0 && shadowCoord.y >= 0.0 && shadowCoord.y <= 1.0;
			bool frustumTest = inFrustum && shadowCoord.z <= 1.0;
			if ( frustumTest ) {
				float depth = texture2D( shadowMap, shadowCoord.xy ).r;
				#ifdef USE_REVERSED_DEPTH_BUFFER
					shadow = step( depth, shadowCoord.z );
				#else
					shadow = step( shadowCoord.z, depth );
				#endif
			}
			return mix( 1.0, shadow, shadowIntensity );
		}
	#endif
	#if NUM_SUN_LIGHT_SHADOWS > 0
		float getSunShadow(
			#if defined( SHADOWMAP_TYPE_PCF )
				sampler2DShadow shadowMap,
			#else
				sampler2D shadowMap,
			#endif
			SunLightShadow sunLightShadow,
			int shadowIndex
		) {
			vec4 shadowWorldPosition = vec4( vSunShadowWorldPosition.xyz + vSunShadowWorldNormal * sunLightShadow.shadowNormalBias, 1.0 );
			float viewDepth = vSunShadowWorldPosition.w;
			int cascadeOffset = shadowIndex * SUN_LIGHT_CASCADES;
			float shadow = 1.0;
			for ( int i = SUN_LIGHT_CASCADES - 1; i >= 0; i -- ) {
				vec4 cascade = sunShadowCascade[ cascadeOffset + i ];
				if ( viewDepth >= cascade.x && viewDepth < cascade.y ) {
					float cascadeShadow = getShadow(
						shadowMap,
						sunLightShadow.shadowMapSize,
						sunLightShadow.shadowIntensity,
						sunLightShadow.shadowBias,
						sunLightShadow.shadowRadius,
						sunShadowMatrix[ cascadeOffset + i ] * shadowWorldPosition
					);
					shadow = mix( cascadeShadow, shadow, smoothstep( cascade.z, cascade.y, viewDepth ) );
				}
			}
			return shadow;
		}
	#endif
	#if NUM_POINT_LIGHT_SHADOWS > 0
	#if defined( SHADOWMAP_TYPE_PCF )
	float getPointShadow( samplerCubeShadow shadowMap, vec2 shadowMapSize, float shadowIntensity, float shadowBias, float shadowRadius, vec4 shadowCoord, float shadowCameraNear, float shadowCameraFar ) {
		float shadow = 1.0;
		vec3 lightToPosition = shadowCoord.xyz;
		vec3 bd3D = normalize( lightToPosition );
		vec3 absVec = abs( lightToPosition );
		float viewSpaceZ = max( max( absVec.x, absVec.y ), absVec.z );
		if ( viewSpaceZ - shadowCameraFar <= 0.0 && viewSpaceZ - shadowCameraNear >= 0.0 ) {
			float lightDistance = length( lightToPosition );
			float depthRange = shadowCameraFar - shadowCameraNear;
			#ifdef USE_REVERSED_DEPTH_BUFFER
				float depthA = - shadowCameraNear / depthRange - shadowBias;
				float depthB = shadowCameraNear * shadowCameraFar / ( depthRange * lightDistance );
			#else
				float depthA = shadowCameraFar / depthRange + shadowBias;
				float depthB = - shadowCameraNear * shadowCameraFar / ( depthRange * lightDistance );
			#endif
			float texelSize = shadowRadius / shadowMapSize.x;
			vec3 absDir = abs( bd3D );
			vec3 tangent = absDir.x > absDir.z ? vec3( 0.0, 1.0, 0.0 ) : vec3( 1.0, 0.0, 0.0 );
			tangent = normalize( cross( bd3D, tangent ) );
			vec3 bitangent = cross( bd3D, tangent );
			float phi = interleavedGradientNoise( gl_FragCoord.xy ) * PI2;
			shadow = 0.0;
			for ( int i = 0; i < 5; i ++ ) {
				vec2 offset = vogelDiskSample( i, 5, phi );
				vec3 direction = bd3D + ( tangent * offset.x + bitangent * offset.y ) * texelSize;
				vec3 absDirection = abs( direction );
				float dp = depthA + depthB / max( max( absDirection.x, absDirection.y ), absDirection.z );
				shadow += texture( shadowMap, vec4( direction, dp ) );
			}
			shadow *= 0.2;
		}
		return mix( 1.0, shadow, shadowIntensity );
	}
	#elif defined( SHADOWMAP_TYPE_BASIC )
	float getPointShadow( samplerCube shadowMap, vec2 shadowMapSize, float shadowIntensity, float shadowBias, float shadowRadius, vec4 shadowCoord, float shadowCameraNear, float shadowCameraFar ) {
		float shadow = 1.0;
		vec3 lightToPosition = shadowCoord.xyz;
		vec3 absVec = abs( lightToPosition );
		float viewSpaceZ = max( max( absVec.x, absVec.y ), absVec.z );
		if ( viewSpaceZ - shadowCameraFar <= 0.0 && viewSpaceZ - shadowCameraNear >= 0.0 ) {
			float dp = ( shadowCameraFar * ( viewSpaceZ - shadowCameraNear ) ) / ( viewSpaceZ * ( shadowCameraFar - shadowCameraNear ) );
			dp += shadowBias;
			vec3 bd3D = normalize( lightToPosition );
			float depth = textureCube( shadowMap, bd3D ).r;
			#ifdef USE_REVERSED_DEPTH_BUFFER
				depth = 1.0 - depth;
			#endif
			shadow = step( dp, depth );
		}
		return mix( 1.0, shadow, shadowIntensity );
	}
	#endif
	#endif
#endif`,Kh=`#if NUM_SPOT_LIGHT_COORDS > 0
	uniform mat4 spotLightMatrix[ NUM_SPOT_LIGHT_COORDS ];
	varying vec4 vSpotLightCoord[ NUM_SPOT_LIGHT_COORDS ];
#endif
#ifdef USE_SHADOWMAP
	#if NUM_SUN_LIGHT_SHADOWS > 0
		varying vec4 vSunShadowWorldPosition;
		varying vec3 vSunShadowWorldNormal;
	#endif
	#if NUM_DIR_LIGHT_SHADOWS > 0
		uniform mat4 directionalShadowMatrix[ NUM_DIR_LIGHT_SHADOWS ];
		varying vec4 vDirectionalShadowCoord[ NUM_DIR_LIGHT_SHADOWS ];
		struct DirectionalLightShadow {
			float shadowIntensity;
			float shadowBias;
			float shadowNormalBias;
			float shadowRadius;
			vec2 shadowMapSize;
		};
		uniform DirectionalLightShadow directionalLightShadows[ NUM_DIR_LIGHT_SHADOWS ];
	#endif
	#if NUM_SPOT_LIGHT_SHADOWS > 0
		struct SpotLightShadow {
			float shadowIntensity;
			float shadowBias;
			float shadowNormalBias;
			float shadowRadius;
			vec2 shadowMapSize;
		};
		uniform SpotLightShadow spotLightShadows[ NUM_SPOT_LIGHT_SHADOWS ];
	#endif
	#if NUM_POINT_LIGHT_SHADOWS > 0
		uniform mat4 pointShadowMatrix[ NUM_POINT_LIGHT_SHADOWS ];
		varying vec4 vPointShadowCoord[ NUM_POINT_LIGHT_SHADOWS ];
		struct PointLightShadow {
			float shadowIntensity;
			float shadowBias;
			float shadowNormalBias;
			float shadowRadius;
			vec2 shadowMapSize;
			float shadowCameraNear;
			float shadowCameraFar;
		};
		uniform PointLightShadow pointLightShadows[ NUM_POINT_LIGHT_SHADOWS ];
	#endif
#endif`,Zh=`#if ( defined( USE_SHADOWMAP ) && ( NUM_DIR_LIGHT_SHADOWS > 0 || NUM_SUN_LIGHT_SHADOWS > 0 || NUM_POINT_LIGHT_SHADOWS > 0 ) ) || ( NUM_SPOT_LIGHT_COORDS > 0 )
	#ifdef HAS_NORMAL
		vec3 shadowWorldNormal = transformNormalByInverseViewMatrix( transformedNormal, viewMatrix );
	#else
		vec3 shadowWorldNormal = vec3( 0.0 );
	#endif
	vec4 shadowWorldPosition;
#endif
#if defined( USE_SHADOWMAP )
	#if NUM_SUN_LIGHT_SHADOWS > 0
		vSunShadowWorldPosition = vec4( worldPosition.xyz, - mvPosition.z );
		vSunShadowWorldNormal = shadowWorldNormal;
	#endif
	#if NUM_DIR_LIGHT_SHADOWS > 0
		#pragma unroll_loop_start
		for ( int i = 0; i < NUM_DIR_LIGHT_SHADOWS; i ++ ) {
			shadowWorldPosition = worldPosition + vec4( shadowWorldNormal * directionalLightShadows[ i ].shadowNormalBias, 0 );
			vDirectionalShadowCoord[ i ] = directionalShadowMatrix[ i ] * shadowWorldPosition;
		}
		#pragma unroll_loop_end
	#endif
	#if NUM_POINT_LIGHT_SHADOWS > 0
		#pragma unroll_loop_start
		for ( int i = 0; i < NUM_POINT_LIGHT_SHADOWS; i ++ ) {
			shadowWorldPosition = worldPosition + vec4( shadowWorldNormal * pointLightShadows[ i ].shadowNormalBias, 0 );
			vPointShadowCoord[ i ] = pointShadowMatrix[ i ] * shadowWorldPosition;
		}
		#pragma unroll_loop_end
	#endif
#endif
#if NUM_SPOT_LIGHT_COORDS > 0
	#pragma unroll_loop_start
	for ( int i = 0; i < NUM_SPOT_LIGHT_COORDS; i ++ ) {
		shadowWorldPosition = worldPosition;
		#if ( defined( USE_SHADOWMAP ) && UNROLLED_LOOP_INDEX < NUM_SPOT_LIGHT_SHADOWS )
			shadowWorldPosition.xyz += shadowWorldNormal * spotLightShadows[ i ].shadowNormalBias;
		#endif
		vSpotLightCoord[ i ] = spotLightMatrix[ i ] * shadowWorldPosition;
	}
	#pragma unroll_loop_end
#endif`,Jh=`float getShadowMask() {
	float shadow = 1.0;
	#ifdef USE_SHADOWMAP
	#if NUM_SUN_LIGHT_SHADOWS > 0
	SunLightShadow sunLight;
	#pragma unroll_loop_start
	for ( int i = 0; i < NUM_SUN_LIGHT_SHADOWS; i ++ ) {
		sunLight = sunLightShadows[ i ];
		shadow *= receiveShadow ? getSunShadow( sunShadowMap[ i ], sunLight, UNROLLED_LOOP_INDEX ) : 1.0;
	}
	#pragma unroll_loop_end
	#endif
	#if NUM_DIR_LIGHT_SHADOWS > 0
	DirectionalLightShadow directionalLight;
	#pragma unroll_loop_start
	for ( int i = 0; i < NUM_DIR_LIGHT_SHADOWS; i ++ ) {
		directionalLight = directionalLightShadows[ i ];
		shadow *= receiveShadow ? getShadow( directionalShadowMap[ i ], directionalLight.shadowMapSize, directionalLight.shadowIntensity, directionalLight.shadowBias, directionalLight.shadowRadius, vDirectionalShadowCoord[ i ] ) : 1.0;
	}
	#pragma unroll_loop_end
	#endif
	#if NUM_SPOT_LIGHT_SHADOWS > 0
	SpotLightShadow spotLight;
	#pragma unroll_loop_start
	for ( int i = 0; i < NUM_SPOT_LIGHT_SHADOWS; i ++ ) {
		spotLight = spotLightShadows[ i ];
		shadow *= receiveShadow ? getShadow( spotShadowMap[ i ], spotLight.shadowMapSize, spotLight.shadowIntensity, spotLight.shadowBias, spotLight.shadowRadius, vSpotLightCoord[ i ] ) : 1.0;
	}
	#pragma unroll_loop_end
	#endif
	#if NUM_POINT_LIGHT_SHADOWS > 0 && ( defined( SHADOWMAP_TYPE_PCF ) || defined( SHADOWMAP_TYPE_BASIC ) )
	PointLightShadow pointLight;
	#pragma unroll_loop_start
	for ( int i = 0; i < NUM_POINT_LIGHT_SHADOWS; i ++ ) {
		pointLight = pointLightShadows[ i ];
		shadow *= receiveShadow ? getPointShadow( pointShadowMap[ i ], pointLight.shadowMapSize, pointLight.shadowIntensity, pointLight.shadowBias, pointLight.shadowRadius, vPointShadowCoord[ i ], pointLight.shadowCameraNear, pointLight.shadowCameraFar ) : 1.0;
	}
	#pragma unroll_loop_end
	#endif
	#endif
	return shadow;
}`,Qh=`#ifdef USE_SKINNING
	mat4 boneMatX = getBoneMatrix( skinIndex.x );
	mat4 boneMatY = getBoneMatrix( skinIndex.y );
	mat4 boneMatZ = getBoneMatrix( skinIndex.z );
	mat4 boneMatW = getBoneMatrix( skinIndex.w );
#endif`,jh=`#ifdef USE_SKINNING
	uniform mat4 bindMatrix;
	uniform mat4 bindMatrixInverse;
	uniform highp sampler2D boneTexture;
	mat4 getBoneMatrix( const in float i ) {
		int size = textureSize( boneTexture, 0 ).x;
		int j = int( i ) * 4;
		int x = j % size;
		int y = j / size;
		vec4 v1 = texelFetch( boneTexture, ivec2( x, y ), 0 );
		vec4 v2 = texelFetch( boneTexture, ivec2( x + 1, y ), 0 );
		vec4 v3 = texelFetch( boneTexture, ivec2( x + 2, y ), 0 );
		vec4 v4 = texelFetch( boneTexture, ivec2( x + 3, y ), 0 );
		return mat4( v1, v2, v3, v4 );
	}
#endif`,ed=`#ifdef USE_SKINNING
	vec4 skinVertex = bindMatrix * vec4( transformed, 1.0 );
	vec4 skinned = vec4( 0.0 );
	skinned += boneMatX * skinVertex * skinWeight.x;
	skinned += boneMatY * skinVertex * skinWeight.y;
	skinned += boneMatZ * skinVertex * skinWeight.z;
	skinned += boneMatW * skinVertex * skinWeight.w;
	transformed = ( bindMatrixInverse * skinned ).xyz;
#endif`,td=`#ifdef USE_SKINNING
	mat4 skinMatrix = mat4( 0.0 );
	skinMatrix += skinWeight.x * boneMatX;
	skinMatrix += skinWeight.y * boneMatY;
	skinMatrix += skinWeight.z * boneMatZ;
	skinMatrix += skinWeight.w * boneMatW;
	skinMatrix = bindMatrixInverse * skinMatrix * bindMatrix;
	objectNormal = vec4( skinMatrix * vec4( objectNormal, 0.0 ) ).xyz;
	#ifdef USE_TANGENT
		objectTangent = vec4( skinMatrix * vec4( objectTangent, 0.0 ) ).xyz;
	#endif
#endif`,nd=`float specularStrength;
#ifdef USE_SPECULARMAP
	vec4 texelSpecular = texture2D( specularMap, vSpecularMapUv );
	specularStrength = texelSpecular.r;
#else
	specularStrength = 1.0;
#endif`,id=`#ifdef USE_SPECULARMAP
	uniform sampler2D specularMap;
#endif`,sd=`#if defined( TONE_MAPPING )
	gl_FragColor.rgb = toneMapping( gl_FragColor.rgb );
#endif`,rd=`#ifndef saturate
#define saturate( a ) clamp( a, 0.0, 1.0 )
#endif
uniform float toneMappingExposure;
vec3 LinearToneMapping( vec3 color ) {
	return saturate( toneMappingExposure * color );
}
vec3 ReinhardToneMapping( vec3 color ) {
	color *= toneMappingExposure;
	return saturate( color / ( vec3( 1.0 ) + color ) );
}
vec3 CineonToneMapping( vec3 color ) {
	color *= toneMappingExposure;
	color = max( vec3( 0.0 ), color - 0.004 );
	return pow( ( color * ( 6.2 * color + 0.5 ) ) / ( color * ( 6.2 * color + 1.7 ) + 0.06 ), vec3( 2.2 ) );
}
vec3 RRTAndODTFit( vec3 v ) {
	vec3 a = v * ( v + 0.0245786 ) - 0.000090537;
	vec3 b = v * ( 0.983729 * v + 0.4329510 ) + 0.238081;
	return a / b;
}
vec3 ACESFilmicToneMapping( vec3 color ) {
	const mat3 ACESInputMat = mat3(
		vec3( 0.59719, 0.07600, 0.02840 ),		vec3( 0.35458, 0.90834, 0.13383 ),
		vec3( 0.04823, 0.01566, 0.83777 )
	);
	const mat3 ACESOutputMat = mat3(
		vec3(  1.60475, -0.10208, -0.00327 ),		vec3( -0.53108,  1.10813, -0.07276 ),
		vec3( -0.07367, -0.00605,  1.07602 )
	);
	color *= toneMappingExposure / 0.6;
	color = ACESInputMat * color;
	color = RRTAndODTFit( color );
	color = ACESOutputMat * color;
	return saturate( color );
}
const mat3 LINEAR_REC2020_TO_LINEAR_SRGB = mat3(
	vec3( 1.6605, - 0.1246, - 0.0182 ),
	vec3( - 0.5876, 1.1329, - 0.1006 ),
	vec3( - 0.0728, - 0.0083, 1.1187 )
);
const mat3 LINEAR_SRGB_TO_LINEAR_REC2020 = mat3(
	vec3( 0.6274, 0.0691, 0.0164 ),
	vec3( 0.3293, 0.9195, 0.0880 ),
	vec3( 0.0433, 0.0113, 0.8956 )
);
vec3 agxDefaultContrastApprox( vec3 x ) {
	vec3 x2 = x * x;
	vec3 x4 = x2 * x2;
	return + 15.5 * x4 * x2
		- 40.14 * x4 * x
		+ 31.96 * x4
		- 6.868 * x2 * x
		+ 0.4298 * x2
		+ 0.1191 * x
		- 0.00232;
}
vec3 AgXToneMapping( vec3 color ) {
	const mat3 AgXInsetMatrix = mat3(
		vec3( 0.856627153315983, 0.137318972929847, 0.11189821299995 ),
		vec3( 0.0951212405381588, 0.761241990602591, 0.0767994186031903 ),
		vec3( 0.0482516061458583, 0.101439036467562, 0.811302368396859 )
	);
	const mat3 AgXOutsetMatrix = mat3(
		vec3( 1.1271005818144368, - 0.1413297634984383, - 0.14132976349843826 ),
		vec3( - 0.11060664309660323, 1.157823702216272, - 0.11060664309660294 ),
		vec3( - 0.016493938717834573, - 0.016493938717834257, 1.2519364065950405 )
	);
	const float AgxMinEv = - 12.47393;	const float AgxMaxEv = 4.026069;
	color *= toneMappingExposure;
	color = LINEAR_SRGB_TO_LINEAR_REC2020 * color;
	color = AgXInsetMatrix * color;
	color = max( color, 1e-10 );	color = log2( color );
	color = ( color - AgxMinEv ) / ( AgxMaxEv - AgxMinEv );
	color = clamp( color, 0.0, 1.0 );
	color = agxDefaultContrastApprox( color );
	color = AgXOutsetMatrix * color;
	color = pow( max( vec3( 0.0 ), color ), vec3( 2.2 ) );
	color = LINEAR_REC2020_TO_LINEAR_SRGB * color;
	color = clamp( color, 0.0, 1.0 );
	return color;
}
vec3 NeutralToneMapping( vec3 color ) {
	const float StartCompression = 0.8 - 0.04;
	const float Desaturation = 0.15;
	color *= toneMappingExposure;
	float x = min( color.r, min( color.g, color.b ) );
	float offset = x < 0.08 ? x - 6.25 * x * x : 0.04;
	color -= offset;
	float peak = max( color.r, max( color.g, color.b ) );
	if ( peak < StartCompression ) return color;
	float d = 1. - StartCompression;
	float newPeak = 1. - d * d / ( peak + d - StartCompression );
	color *= newPeak / peak;
	float g = 1. - 1. / ( Desaturation * ( peak - newPeak ) + 1. );
	return mix( color, vec3( newPeak ), g );
}
vec3 CustomToneMapping( vec3 color ) { return color; }`,ad=`#ifdef USE_TRANSMISSION
	material.transmission = transmission;
	material.transmissionAlpha = 1.0;
	material.thickness = thickness;
	material.attenuationDistance = attenuationDistance;
	material.attenuationColor = attenuationColor;
	#ifdef USE_TRANSMISSIONMAP
		material.transmission *= texture2D( transmissionMap, vTransmissionMapUv ).r;
	#endif
	#ifdef USE_THICKNESSMAP
		material.thickness *= texture2D( thicknessMap, vThicknessMapUv ).g;
	#endif
	vec3 pos = vWorldPosition;
	vec3 v = normalize( cameraPosition - pos );
	vec3 n = transformNormalByInverseViewMatrix( normal, viewMatrix );
	vec4 transmitted = getIBLVolumeRefraction(
		n, v, material.roughness, material.diffuseContribution, material.specularColorBlended, material.specularF90,
		pos, modelMatrix, viewMatrix, projectionMatrix, material.dispersion, material.ior, material.thickness,
		material.attenuationColor, material.attenuationDistance );
	material.transmissionAlpha = mix( material.transmissionAlpha, transmitted.a, material.transmission );
	totalDiffuse = mix( totalDiffuse, transmitted.rgb, material.transmission );
#endif`,od=`#ifdef USE_TRANSMISSION
	uniform float transmission;
	uniform float thickness;
	uniform float attenuationDistance;
	uniform vec3 attenuationColor;
	#ifdef USE_TRANSMISSIONMAP
		uniform sampler2D transmissionMap;
	#endif
	#ifdef USE_THICKNESSMAP
		uniform sampler2D thicknessMap;
	#endif
	uniform vec2 transmissionSamplerSize;
	uniform sampler2D transmissionSamplerMap;
	uniform mat4 modelMatrix;
	uniform mat4 projectionMatrix;
	varying vec3 vWorldPosition;
	float w0( float a ) {
		return ( 1.0 / 6.0 ) * ( a * ( a * ( - a + 3.0 ) - 3.0 ) + 1.0 );
	}
	float w1( float a ) {
		return ( 1.0 / 6.0 ) * ( a *  a * ( 3.0 * a - 6.0 ) + 4.0 );
	}
	float w2( float a ){
		return ( 1.0 / 6.0 ) * ( a * ( a * ( - 3.0 * a + 3.0 ) + 3.0 ) + 1.0 );
	}
	float w3( float a ) {
		return ( 1.0 / 6.0 ) * ( a * a * a );
	}
	float g0( float a ) {
		return w0( a ) + w1( a );
	}
	float g1( float a ) {
		return w2( a ) + w3( a );
	}
	float h0( float a ) {
		return - 1.0 + w1( a ) / ( w0( a ) + w1( a ) );
	}
	float h1( float a ) {
		return 1.0 + w3( a ) / ( w2( a ) + w3( a ) );
	}
	vec4 bicubic( sampler2D tex, vec2 uv, vec4 texelSize, float lod ) {
		uv = uv * texelSize.zw + 0.5;
		vec2 iuv = floor( uv );
		vec2 fuv = fract( uv );
		float g0x = g0( fuv.x );
		float g1x = g1( fuv.x );
		float h0x = h0( fuv.x );
		float h1x = h1( fuv.x );
		float h0y = h0( fuv.y );
		float h1y = h1( fuv.y );
		vec2 p0 = ( vec2( iuv.x + h0x, iuv.y + h0y ) - 0.5 ) * texelSize.xy;
		vec2 p1 = ( vec2( iuv.x + h1x, iuv.y + h0y ) - 0.5 ) * texelSize.xy;
		vec2 p2 = ( vec2( iuv.x + h0x, iuv.y + h1y ) - 0.5 ) * texelSize.xy;
		vec2 p3 = ( vec2( iuv.x + h1x, iuv.y + h1y ) - 0.5 ) * texelSize.xy;
		return g0( fuv.y ) * ( g0x * textureLod( tex, p0, lod ) + g1x * textureLod( tex, p1, lod ) ) +
			g1( fuv.y ) * ( g0x * textureLod( tex, p2, lod ) + g1x * textureLod( tex, p3, lod ) );
	}
	vec4 textureBicubic( sampler2D sampler, vec2 uv, float lod ) {
		vec2 fLodSize = vec2( textureSize( sampler, int( lod ) ) );
		vec2 cLodSize = vec2( textureSize( sampler, int( lod + 1.0 ) ) );
		vec2 fLodSizeInv = 1.0 / fLodSize;
		vec2 cLodSizeInv = 1.0 / cLodSize;
		vec4 fSample = bicubic( sampler, uv, vec4( fLodSizeInv, fLodSize ), floor( lod ) );
		vec4 cSample = bicubic( sampler, uv, vec4( cLodSizeInv, cLodSize ), ceil( lod ) );
		return mix( fSample, cSample, fract( lod ) );
	}
	vec3 getVolumeTransmissionRay( const in vec3 n, const in vec3 v, const in float thickness, const in float ior, const in mat4 modelMatrix ) {
		vec3 refractionVector = refract( - v, normalize( n ), 1.0 / ior );
		vec3 modelScale;
		modelScale.x = length( vec3( modelMatrix[ 0 ].xyz ) );
		modelScale.y = length( vec3( modelMatrix[ 1 ].xyz ) );
		modelScale.z = length( vec3( modelMatrix[ 2 ].xyz ) );
		return normalize( refractionVector ) * thickness * modelScale;
	}
	float applyIorToRoughness( const in float roughness, const in float ior ) {
		return roughness * clamp( ior * 2.0 - 2.0, 0.0, 1.0 );
	}
	vec4 getTransmissionSample( const in vec2 fragCoord, const in float roughness, const in float ior ) {
		float lod = log2( transmissionSamplerSize.x ) * applyIorToRoughness( roughness, ior );
		return textureBicubic( transmissionSamplerMap, fragCoord.xy, lod );
	}
	vec3 volumeAttenuation( const in float transmissionDistance, const in vec3 attenuationColor, const in float attenuationDistance ) {
		if ( isinf( attenuationDistance ) ) {
			return vec3( 1.0 );
		} else {
			vec3 attenuationCoefficient = -log( attenuationColor ) / attenuationDistance;
			vec3 transmittance = exp( - attenuationCoefficient * transmissionDistance );			return transmittance;
		}
	}
	vec4 getIBLVolumeRefraction( const in vec3 n, const in vec3 v, const in float roughness, const in vec3 diffuseColor,
		const in vec3 specularColor, const in float specularF90, const in vec3 position, const in mat4 modelMatrix,
		const in mat4 viewMatrix, const in mat4 projMatrix, const in float dispersion, const in float ior, const in float thickness,
		const in vec3 attenuationColor, const in float attenuationDistance ) {
		vec4 transmittedLight;
		vec3 transmittance;
		#ifdef USE_DISPERSION
			float halfSpread = ( ior - 1.0 ) * 0.025 * dispersion;
			vec3 iors = vec3( ior - halfSpread, ior, ior + halfSpread );
			for ( int i = 0; i < 3; i ++ ) {
				vec3 transmissionRay = getVolumeTransmissionRay( n, v, thickness, iors[ i ], modelMatrix );
				vec3 refractedRayExit = position + transmissionRay;
				vec4 ndcPos = projMatrix * viewMatrix * vec4( refractedRayExit, 1.0 );
				vec2 refractionCoords = ndcPos.xy / ndcPos.w;
				refractionCoords += 1.0;
				refractionCoords /= 2.0;
				vec4 transmissionSample = getTransmissionSample( refractionCoords, roughness, iors[ i ] );
				transmittedLight[ i ] = transmissionSample[ i ];
				transmittedLight.a += transmissionSample.a;
				transmittance[ i ] = diffuseColor[ i ] * volumeAttenuation( length( transmissionRay ), attenuationColor, attenuationDistance )[ i ];
			}
			transmittedLight.a /= 3.0;
		#else
			vec3 transmissionRay = getVolumeTransmissionRay( n, v, thickness, ior, modelMatrix );
			vec3 refractedRayExit = position + transmissionRay;
			vec4 ndcPos = projMatrix * viewMatrix * vec4( refractedRayExit, 1.0 );
			vec2 refractionCoords = ndcPos.xy / ndcPos.w;
			refractionCoords += 1.0;
			refractionCoords /= 2.0;
			transmittedLight = getTransmissionSample( refractionCoords, roughness, ior );
			transmittance = diffuseColor * volumeAttenuation( length( transmissionRay ), attenuationColor, attenuationDistance );
		#endif
		vec3 attenuatedColor = transmittance * transmittedLight.rgb;
		vec3 F = EnvironmentBRDF( n, v, specularColor, specularF90, roughness );
		float transmittanceFactor = ( transmittance.r + transmittance.g + transmittance.b ) / 3.0;
		return vec4( ( 1.0 - F ) * attenuatedColor, 1.0 - ( 1.0 - transmittedLight.a ) * transmittanceFactor );
	}
#endif`,ld=`#if defined( USE_UV ) || defined( USE_ANISOTROPY )
	varying vec2 vUv;
#endif
#ifdef USE_MAP
	varying vec2 vMapUv;
#endif
#ifdef USE_ALPHAMAP
	varying vec2 vAlphaMapUv;
#endif
#ifdef USE_LIGHTMAP
	varying vec2 vLightMapUv;
#endif
#ifdef USE_AOMAP
	varying vec2 vAoMapUv;
#endif
#ifdef USE_BUMPMAP
	varying vec2 vBumpMapUv;
#endif
#ifdef USE_NORMALMAP
	varying vec2 vNormalMapUv;
#endif
#ifdef USE_EMISSIVEMAP
	varying vec2 vEmissiveMapUv;
#endif
#ifdef USE_METALNESSMAP
	varying vec2 vMetalnessMapUv;
#endif
#ifdef USE_ROUGHNESSMAP
	varying vec2 vRoughnessMapUv;
#endif
#ifdef USE_DIFFUSE_ROUGHNESSMAP
	varying vec2 vDiffuseRoughnessMapUv;
#endif
#ifdef USE_ANISOTROPYMAP
	varying vec2 vAnisotropyMapUv;
#endif
#ifdef USE_CLEARCOATMAP
	varying vec2 vClearcoatMapUv;
#endif
#ifdef USE_CLEARCOAT_NORMALMAP
	varying vec2 vClearcoatNormalMapUv;
#endif
#ifdef USE_CLEARCOAT_ROUGHNESSMAP
	varying vec2 vClearcoatRoughnessMapUv;
#endif
#ifdef USE_IRIDESCENCEMAP
	varying vec2 vIridescenceMapUv;
#endif
#ifdef USE_IRIDESCENCE_THICKNESSMAP
	varying vec2 vIridescenceThicknessMapUv;
#endif
#ifdef USE_SHEEN_COLORMAP
	varying vec2 vSheenColorMapUv;
#endif
#ifdef USE_SHEEN_ROUGHNESSMAP
	varying vec2 vSheenRoughnessMapUv;
#endif
#ifdef USE_SPECULARMAP
	varying vec2 vSpecularMapUv;
#endif
#ifdef USE_SPECULAR_COLORMAP
	varying vec2 vSpecularColorMapUv;
#endif
#ifdef USE_SPECULAR_INTENSITYMAP
	varying vec2 vSpecularIntensityMapUv;
#endif
#ifdef USE_TRANSMISSIONMAP
	uniform mat3 transmissionMapTransform;
	varying vec2 vTransmissionMapUv;
#endif
#ifdef USE_THICKNESSMAP
	uniform mat3 thicknessMapTransform;
	varying vec2 vThicknessMapUv;
#endif`,cd=`#if defined( USE_UV ) || defined( USE_ANISOTROPY )
	varying vec2 vUv;
#endif
#ifdef USE_MAP
	uniform mat3 mapTransform;
	varying vec2 vMapUv;
#endif
#ifdef USE_ALPHAMAP
	uniform mat3 alphaMapTransform;
	varying vec2 vAlphaMapUv;
#endif
#ifdef USE_LIGHTMAP
	uniform mat3 lightMapTransform;
	varying vec2 vLightMapUv;
#endif
#ifdef USE_AOMAP
	uniform mat3 aoMapTransform;
	varying vec2 vAoMapUv;
#endif
#ifdef USE_BUMPMAP
	uniform mat3 bumpMapTransform;
	varying vec2 vBumpMapUv;
#endif
#ifdef USE_NORMALMAP
	uniform mat3 normalMapTransform;
	varying vec2 vNormalMapUv;
#endif
#ifdef USE_DISPLACEMENTMAP
	uniform mat3 displacementMapTransform;
	varying vec2 vDisplacementMapUv;
#endif
#ifdef USE_EMISSIVEMAP
	uniform mat3 emissiveMapTransform;
	varying vec2 vEmissiveMapUv;
#endif
#ifdef USE_METALNESSMAP
	uniform mat3 metalnessMapTransform;
	varying vec2 vMetalnessMapUv;
#endif
#ifdef USE_ROUGHNESSMAP
	uniform mat3 roughnessMapTransform;
	varying vec2 vRoughnessMapUv;
#endif
#ifdef USE_DIFFUSE_ROUGHNESSMAP
	uniform mat3 diffuseRoughnessMapTransform;
	varying vec2 vDiffuseRoughnessMapUv;
#endif
#ifdef USE_ANISOTROPYMAP
	uniform mat3 anisotropyMapTransform;
	varying vec2 vAnisotropyMapUv;
#endif
#ifdef USE_CLEARCOATMAP
	uniform mat3 clearcoatMapTransform;
	varying vec2 vClearcoatMapUv;
#endif
#ifdef USE_CLEARCOAT_NORMALMAP
	uniform mat3 clearcoatNormalMapTransform;
	varying vec2 vClearcoatNormalMapUv;
#endif
#ifdef USE_CLEARCOAT_ROUGHNESSMAP
	uniform mat3 clearcoatRoughnessMapTransform;
	varying vec2 vClearcoatRoughnessMapUv;
#endif
#ifdef USE_SHEEN_COLORMAP
	uniform mat3 sheenColorMapTransform;
	varying vec2 vSheenColorMapUv;
#endif
#ifdef USE_SHEEN_ROUGHNESSMAP
	uniform mat3 sheenRoughnessMapTransform;
	varying vec2 vSheenRoughnessMapUv;
#endif
#ifdef USE_IRIDESCENCEMAP
	uniform mat3 iridescenceMapTransform;
	varying vec2 vIridescenceMapUv;
#endif
#ifdef USE_IRIDESCENCE_THICKNESSMAP
	uniform mat3 iridescenceThicknessMapTransform;
	varying vec2 vIridescenceThicknessMapUv;
#endif
#ifdef USE_SPECULARMAP
	uniform mat3 specularMapTransform;
	varying vec2 vSpecularMapUv;
#endif
#ifdef USE_SPECULAR_COLORMAP
	uniform mat3 specularColorMapTransform;
	varying vec2 vSpecularColorMapUv;
#endif
#ifdef USE_SPECULAR_INTENSITYMAP
	uniform mat3 specularIntensityMapTransform;
	varying vec2 vSpecularIntensityMapUv;
#endif
#ifdef USE_TRANSMISSIONMAP
	uniform mat3 transmissionMapTransform;
	varying vec2 vTransmissionMapUv;
#endif
#ifdef USE_THICKNESSMAP
	uniform mat3 thicknessMapTransform;
	varying vec2 vThicknessMapUv;
#endif`,hd=`#if defined( USE_UV ) || defined( USE_ANISOTROPY )
	vUv = vec3( uv, 1 ).xy;
#endif
#ifdef USE_MAP
	vMapUv = ( mapTransform * vec3( MAP_UV, 1 ) ).xy;
#endif
#ifdef USE_ALPHAMAP
	vAlphaMapUv = ( alphaMapTransform * vec3( ALPHAMAP_UV, 1 ) ).xy;
#endif
#ifdef USE_LIGHTMAP
	vLightMapUv = ( lightMapTransform * vec3( LIGHTMAP_UV, 1 ) ).xy;
#endif
#ifdef USE_AOMAP
	vAoMapUv = ( aoMapTransform * vec3( AOMAP_UV, 1 ) ).xy;
#endif
#ifdef USE_BUMPMAP
	vBumpMapUv = ( bumpMapTransform * vec3( BUMPMAP_UV, 1 ) ).xy;
#endif
#ifdef USE_NORMALMAP
	vNormalMapUv = ( normalMapTransform * vec3( NORMALMAP_UV, 1 ) ).xy;
#endif
#ifdef USE_DISPLACEMENTMAP
	vDisplacementMapUv = ( displacementMapTransform * vec3( DISPLACEMENTMAP_UV, 1 ) ).xy;
#endif
#ifdef USE_EMISSIVEMAP
	vEmissiveMapUv = ( emissiveMapTransform * vec3( EMISSIVEMAP_UV, 1 ) ).xy;
#endif
#ifdef USE_METALNESSMAP
	vMetalnessMapUv = ( metalnessMapTransform * vec3( METALNESSMAP_UV, 1 ) ).xy;
#endif
#ifdef USE_ROUGHNESSMAP
	vRoughnessMapUv = ( roughnessMapTransform * vec3( ROUGHNESSMAP_UV, 1 ) ).xy;
#endif
#ifdef USE_DIFFUSE_ROUGHNESSMAP
	vDiffuseRoughnessMapUv = ( diffuseRoughnessMapTransform * vec3( DIFFUSE_ROUGHNESSMAP_UV, 1 ) ).xy;
#endif
#ifdef USE_ANISOTROPYMAP
	vAnisotropyMapUv = ( anisotropyMapTransform * vec3( ANISOTROPYMAP_UV, 1 ) ).xy;
#endif
#ifdef USE_CLEARCOATMAP
	vClearcoatMapUv = ( clearcoatMapTransform * vec3( CLEARCOATMAP_UV, 1 ) ).xy;
#endif
#ifdef USE_CLEARCOAT_NORMALMAP
	vClearcoatNormalMapUv = ( clearcoatNormalMapTransform * vec3( CLEARCOAT_NORMALMAP_UV, 1 ) ).xy;
#endif
#ifdef USE_CLEARCOAT_ROUGHNESSMAP
	vClearcoatRoughnessMapUv = ( clearcoatRoughnessMapTransform * vec3( CLEARCOAT_ROUGHNESSMAP_UV, 1 ) ).xy;
#endif
#ifdef USE_IRIDESCENCEMAP
	vIridescenceMapUv = ( iridescenceMapTransform * vec3( IRIDESCENCEMAP_UV, 1 ) ).xy;
#endif
#ifdef USE_IRIDESCENCE_THICKNESSMAP
	vIridescenceThicknessMapUv = ( iridescenceThicknessMapTransform * vec3( IRIDESCENCE_THICKNESSMAP_UV, 1 ) ).xy;
#endif
#ifdef USE_SHEEN_COLORMAP
	vSheenColorMapUv = ( sheenColorMapTransform * vec3( SHEEN_COLORMAP_UV, 1 ) ).xy;
#endif
#ifdef USE_SHEEN_ROUGHNESSMAP
	vSheenRoughnessMapUv = ( sheenRoughnessMapTransform * vec3( SHEEN_ROUGHNESSMAP_UV, 1 ) ).xy;
#endif
#ifdef USE_SPECULARMAP
	vSpecularMapUv = ( specularMapTransform * vec3( SPECULARMAP_UV, 1 ) ).xy;
#endif
#ifdef USE_SPECULAR_COLORMAP
	vSpecularColorMapUv = ( specularColorMapTransform * vec3( SPECULAR_COLORMAP_UV, 1 ) ).xy;
#endif
#ifdef USE_SPECULAR_INTENSITYMAP
	vSpecularIntensityMapUv = ( specularIntensityMapTransform * vec3( SPECULAR_INTENSITYMAP_UV, 1 ) ).xy;
#endif
#ifdef USE_TRANSMISSIONMAP
	vTransmissionMapUv = ( transmissionMapTransform * vec3( TRANSMISSIONMAP_UV, 1 ) ).xy;
#endif
#ifdef USE_THICKNESSMAP
	vThicknessMapUv = ( thicknessMapTransform * vec3( THICKNESSMAP_UV, 1 ) ).xy;
#endif`,dd=`#if defined( USE_ENVMAP ) || defined( DISTANCE ) || defined ( USE_SHADOWMAP ) || defined ( USE_TRANSMISSION ) || NUM_SPOT_LIGHT_COORDS > 0
	vec4 worldPosition = vec4( transformed, 1.0 );
	#ifdef USE_BATCHING
		worldPosition = batchingMatrix * worldPosition;
	#endif
	#ifdef USE_INSTANCING
		worldPosition = instanceMatrix * worldPosition;
	#endif
	worldPosition = modelMatrix * worldPosition;
#endif`;const ud=`varying vec2 vUv;
uniform mat3 uvTransform;
void main() {
	vUv = ( uvTransform * vec3( uv, 1 ) ).xy;
	gl_Position = vec4( position.xy, 1.0, 1.0 );
}`,fd=`uniform sampler2D t2D;
uniform float backgroundIntensity;
varying vec2 vUv;
void main() {
	vec4 texColor = texture2D( t2D, vUv );
	#ifdef DECODE_VIDEO_TEXTURE
		texColor = vec4( mix( pow( texColor.rgb * 0.9478672986 + vec3( 0.0521327014 ), vec3( 2.4 ) ), texColor.rgb * 0.0773993808, vec3( lessThanEqual( texColor.rgb, vec3( 0.04045 ) ) ) ), texColor.w );
	#endif
	texColor.rgb *= backgroundIntensity;
	gl_FragColor = texColor;
	#include <tonemapping_fragment>
	#include <colorspace_fragment>
}`,pd=`varying vec3 vWorldDirection;
#include <common>
void main() {
	vWorldDirection = transformDirection( position, modelMatrix );
	#include <begin_vertex>
	#include <project_vertex>
	gl_Position.z = gl_Position.w;
}`,md=`uniform float backgroundBlurriness;
uniform float backgroundIntensity;
uniform mat3 backgroundRotation;
varying vec3 vWorldDirection;
#include <envmap_common_pars_fragment>
void main() {
	#ifdef ENVMAP_TYPE_PMREM
		vec4 texColor = textureLod( envMap, backgroundRotation * vWorldDirection, roughnessToMip( backgroundBlurriness ) );
	#else
		vec4 texColor = textureCube( envMap, backgroundRotation * vWorldDirection );
	#endif
	texColor.rgb *= backgroundIntensity;
	gl_FragColor = texColor;
	#include <tonemapping_fragment>
	#include <colorspace_fragment>
}`,gd=`varying vec3 vWorldDirection;
#include <common>
void main() {
	vWorldDirection = transformDirection( position, modelMatrix );
	#include <begin_vertex>
	#include <project_vertex>
	gl_Position.z = gl_Position.w;
}`,_d=`uniform samplerCube tCube;
uniform float tFlip;
uniform float opacity;
varying vec3 vWorldDirection;
void main() {
	vec4 texColor = textureCube( tCube, vec3( tFlip * vWorldDirection.x, vWorldDirection.yz ) );
	gl_FragColor = texColor;
	gl_FragColor.a *= opacity;
	#include <tonemapping_fragment>
	#include <colorspace_fragment>
}`,vd=`#include <common>
#include <batching_pars_vertex>
#include <uv_pars_vertex>
#include <displacementmap_pars_vertex>
#include <morphtarget_pars_vertex>
#include <skinning_pars_vertex>
#include <logdepthbuf_pars_vertex>
#include <clipping_planes_pars_vertex>
varying vec2 vHighPrecisionZW;
void main() {
	#include <uv_vertex>
	#include <batching_vertex>
	#include <skinbase_vertex>
	#include <morphinstance_vertex>
	#ifdef USE_DISPLACEMENTMAP
		#include <beginnormal_vertex>
		#include <morphnormal_vertex>
		#include <skinnormal_vertex>
	#endif
	#include <begin_vertex>
	#include <morphtarget_vertex>
	#include <skinning_vertex>
	#include <displacementmap_vertex>
	#include <project_vertex>
	#include <logdepthbuf_vertex>
	#include <clipping_planes_vertex>
	vHighPrecisionZW = gl_Position.zw;
}`,xd=`#if DEPTH_PACKING == 3200
	uniform float opacity;
#endif
#include <common>
#include <packing>
#include <uv_pars_fragment>
#include <map_pars_fragment>
#include <alphamap_pars_fragment>
#include <alphatest_pars_fragment>
#include <alphahash_pars_fragment>
#include <logdepthbuf_pars_fragment>
#include <clipping_planes_pars_fragment>
varying vec2 vHighPrecisionZW;
void main() {
	vec4 diffuseColor = vec4( 1.0 );
	#include <clipping_planes_fragment>
	#if DEPTH_PACKING == 3200
		diffuseColor.a = opacity;
	#endif
	#include <map_fragment>
	#include <alphamap_fragment>
	#include <alphatest_fragment>
	#include <alphahash_fragment>
	#include <logdepthbuf_fragment>
	#ifdef USE_REVERSED_DEPTH_BUFFER
		float fragCoordZ = vHighPrecisionZW[ 0 ] / vHighPrecisionZW[ 1 ];
	#else
		float fragCoordZ = 0.5 * vHighPrecisionZW[ 0 ] / vHighPrecisionZW[ 1 ] + 0.5;
	#endif
	#if DEPTH_PACKING == 3200
		gl_FragColor = vec4( vec3( 1.0 - fragCoordZ ), opacity );
	#elif DEPTH_PACKING == 3201
		gl_FragColor = packDepthToRGBA( fragCoordZ );
	#elif DEPTH_PACKING == 3202
		gl_FragColor = vec4( packDepthToRGB( fragCoordZ ), 1.0 );
	#elif DEPTH_PACKING == 3203
		gl_FragColor = vec4( packDepthToRG( fragCoordZ ), 0.0, 1.0 );
	#endif
}`,Sd=`#define DISTANCE
varying vec3 vWorldPosition;
#include <common>
#include <batching_pars_vertex>
#include <uv_pars_vertex>
#include <displacementmap_pars_vertex>
#include <morphtarget_pars_vertex>
#include <skinning_pars_vertex>
#include <clipping_planes_pars_vertex>
void main() {
	#include <uv_vertex>
	#include <batching_vertex>
	#include <skinbase_vertex>
	#include <morphinstance_vertex>
	#ifdef USE_DISPLACEMENTMAP
		#include <beginnormal_vertex>
		#include <morphnormal_vertex>
		#include <skinnormal_vertex>
	#endif
	#include <begin_vertex>
	#include <morphtarget_vertex>
	#include <skinning_vertex>
	#include <displacementmap_vertex>
	#include <project_vertex>
	#include <worldpos_vertex>
	#include <clipping_planes_vertex>
	vWorldPosition = worldPosition.xyz;
}`,Md=`#define DISTANCE
uniform vec3 referencePosition;
uniform float nearDistance;
uniform float farDistance;
varying vec3 vWorldPosition;
#include <common>
#include <uv_pars_fragment>
#include <map_pars_fragment>
#include <alphamap_pars_fragment>
#include <alphatest_pars_fragment>
#include <alphahash_pars_fragment>
#include <clipping_planes_pars_fragment>
void main() {
	vec4 diffuseColor = vec4( 1.0 );
	#include <clipping_planes_fragment>
	#include <map_fragment>
	#include <alphamap_fragment>
	#include <alphatest_fragment>
	#include <alphahash_fragment>
	float dist = length( vWorldPosition - referencePosition );
	dist = ( dist - nearDistance ) / ( farDistance - nearDistance );
	dist = saturate( dist );
	gl_FragColor = vec4( dist, 0.0, 0.0, 1.0 );
}`,wd=`varying vec3 vWorldDirection;
#include <common>
void main() {
	vWorldDirection = transformDirection( position, modelMatrix );
	#include <begin_vertex>
	#include <project_vertex>
}`,yd=`uniform sampler2D tEquirect;
varying vec3 vWorldDirection;
#include <common>
void main() {
	vec3 direction = normalize( vWorldDirection );
	vec2 sampleUV = equirectUv( direction );
	gl_FragColor = texture2D( tEquirect, sampleUV );
	#include <tonemapping_fragment>
	#include <colorspace_fragment>
}`,bd=`uniform float scale;
attribute float lineDistance;
varying float vLineDistance;
#include <common>
#include <uv_pars_vertex>
#include <color_pars_vertex>
#include <fog_pars_vertex>
#include <morphtarget_pars_vertex>
#include <logdepthbuf_pars_vertex>
#include <clipping_planes_pars_vertex>
void main() {
	vLineDistance = scale * lineDistance;
	#include <uv_vertex>
	#include <color_vertex>
	#include <morphinstance_vertex>
	#include <morphcolor_vertex>
	#include <begin_vertex>
	#include <morphtarget_vertex>
	#include <project_vertex>
	#include <logdepthbuf_vertex>
	#include <clipping_planes_vertex>
	#include <fog_vertex>
}`,Ed=`uniform vec3 diffuse;
uniform float opacity;
uniform float dashSize;
uniform float totalSize;
varying float vLineDistance;
#include <common>
#include <color_pars_fragment>
#include <uv_pars_fragment>
#include <map_pars_fragment>
#include <fog_pars_fragment>
#include <logdepthbuf_pars_fragment>
#include <clipping_planes_pars_fragment>
void main() {
	vec4 diffuseColor = vec4( diffuse, opacity );
	#include <clipping_planes_fragment>
	if ( mod( vLineDistance, totalSize ) > dashSize ) {
		discard;
	}
	vec3 outgoingLight = vec3( 0.0 );
	#include <logdepthbuf_fragment>
	#include <map_fragment>
	#include <color_fragment>
	outgoingLight = diffuseColor.rgb;
	#include <opaque_fragment>
	#include <tonemapping_fragment>
	#include <colorspace_fragment>
	#include <fog_fragment>
	#include <premultiplied_alpha_fragment>
}`,Td=`#include <common>
#include <batching_pars_vertex>
#include <uv_pars_vertex>
#include <envmap_pars_vertex>
#include <color_pars_vertex>
#include <fog_pars_vertex>
#include <morphtarget_pars_vertex>
#include <skinning_pars_vertex>
#include <logdepthbuf_pars_vertex>
#include <clipping_planes_pars_vertex>
void main() {
	#include <uv_vertex>
	#include <color_vertex>
	#include <morphinstance_vertex>
	#include <morphcolor_vertex>
	#include <batching_vertex>
	#if defined ( USE_ENVMAP ) || defined ( USE_SKINNING )
		#include <beginnormal_vertex>
		#include <morphnormal_vertex>
		#include <skinbase_vertex>
		#include <skinnormal_vertex>
		#include <defaultnormal_vertex>
	#endif
	#include <begin_vertex>
	#include <morphtarget_vertex>
	#include <skinning_vertex>
	#include <project_vertex>
	#include <logdepthbuf_vertex>
	#include <clipping_planes_vertex>
	#include <worldpos_vertex>
	#include <envmap_vertex>
	#include <fog_vertex>
}`,Ad=`uniform vec3 diffuse;
uniform float opacity;
#ifndef FLAT_SHADED
	varying vec3 vNormal;
#endif
#include <common>
#include <dithering_pars_fragment>
#include <color_pars_fragment>
#include <uv_pars_fragment>
#include <map_pars_fragment>
#include <alphamap_pars_fragment>
#include <alphatest_pars_fragment>
#include <alphahash_pars_fragment>
#include <aomap_pars_fragment>
#include <lightmap_pars_fragment>
#include <envmap_common_pars_fragment>
#include <envmap_pars_fragment>
#include <fog_pars_fragment>
#include <specularmap_pars_fragment>
#include <logdepthbuf_pars_fragment>
#include <clipping_planes_pars_fragment>
void main() {
	vec4 diffuseColor = vec4( diffuse, opacity );
	#include <clipping_planes_fragment>
	#include <logdepthbuf_fragment>
	#include <map_fragment>
	#include <color_fragment>
	#include <alphamap_fragment>
	#include <alphatest_fragment>
	#include <alphahash_fragment>
	#include <specularmap_fragment>
	ReflectedLight reflectedLight = ReflectedLight( vec3( 0.0 ), vec3( 0.0 ), vec3( 0.0 ), vec3( 0.0 ) );
	#ifdef USE_LIGHTMAP
		vec4 lightMapTexel = texture2D( lightMap, vLightMapUv );
		reflectedLight.indirectDiffuse += lightMapTexel.rgb * lightMapIntensity * RECIPROCAL_PI;
	#else
		reflectedLight.indirectDiffuse += vec3( 1.0 );
	#endif
	#include <aomap_fragment>
	reflectedLight.indirectDiffuse *= diffuseColor.rgb;
	vec3 outgoingLight = reflectedLight.indirectDiffuse;
	#include <envmap_fragment>
	#include <opaque_fragment>
	#include <tonemapping_fragment>
	#include <colorspace_fragment>
	#include <fog_fragment>
	#include <premultiplied_alpha_fragment>
	#include <dithering_fragment>
}`,Rd=`#define LAMBERT
varying vec3 vViewPosition;
#include <common>
#include <batching_pars_vertex>
#include <uv_pars_vertex>
#include <displacementmap_pars_vertex>
#include <envmap_pars_vertex>
#include <color_pars_vertex>
#include <fog_pars_vertex>
#include <normal_pars_vertex>
#include <morphtarget_pars_vertex>
#include <skinning_pars_vertex>
#include <shadowmap_pars_vertex>
#include <logdepthbuf_pars_vertex>
#include <clipping_planes_pars_vertex>
void main() {
	#include <uv_vertex>
	#include <color_vertex>
	#include <morphinstance_vertex>
	#include <morphcolor_vertex>
	#include <batching_vertex>
	#include <beginnormal_vertex>
	#include <morphnormal_vertex>
	#include <skinbase_vertex>
	#include <skinnormal_vertex>
	#include <defaultnormal_vertex>
	#include <normal_vertex>
	#include <begin_vertex>
	#include <morphtarget_vertex>
	#include <skinning_vertex>
	#include <displacementmap_vertex>
	#include <project_vertex>
	#include <logdepthbuf_vertex>
	#include <clipping_planes_vertex>
	vViewPosition = - mvPosition.xyz;
	#include <worldpos_vertex>
	#include <envmap_vertex>
	#include <shadowmap_vertex>
	#include <fog_vertex>
}`,Cd=`#define LAMBERT
uniform vec3 diffuse;
uniform vec3 emissive;
uniform float opacity;
#include <common>
#include <dithering_pars_fragment>
#include <color_pars_fragment>
#include <uv_pars_fragment>
#include <map_pars_fragment>
#include <alphamap_pars_fragment>
#include <alphatest_pars_fragment>
#include <alphahash_pars_fragment>
#include <aomap_pars_fragment>
#include <lightmap_pars_fragment>
#include <emissivemap_pars_fragment>
#include <envmap_common_pars_fragment>
#include <envmap_pars_fragment>
#include <envmap_physical_pars_fragment>
#include <fog_pars_fragment>
#include <bsdfs>
#include <lights_pars_begin>
#include <normal_pars_fragment>
#include <lights_lambert_pars_fragment>
#include <shadowmap_pars_fragment>
#include <bumpmap_pars_fragment>
#include <normalmap_pars_fragment>
#include <specularmap_pars_fragment>
#include <logdepthbuf_pars_fragment>
#include <clipping_planes_pars_fragment>
void main() {
	vec4 diffuseColor = vec4( diffuse, opacity );
	#include <clipping_planes_fragment>
	ReflectedLight reflectedLight = ReflectedLight( vec3( 0.0 ), vec3( 0.0 ), vec3( 0.0 ), vec3( 0.0 ) );
	vec3 totalEmissiveRadiance = emissive;
	#include <logdepthbuf_fragment>
	#include <map_fragment>
	#include <color_fragment>
	#include <alphamap_fragment>
	#include <alphatest_fragment>
	#include <alphahash_fragment>
	#include <specularmap_fragment>
	#include <normal_fragment_begin>
	#include <normal_fragment_maps>
	#include <emissivemap_fragment>
	#include <lights_lambert_fragment>
	#include <lights_fragment_begin>
	#include <lights_fragment_maps>
	#include <lights_fragment_end>
	#include <aomap_fragment>
	vec3 outgoingLight = reflectedLight.directDiffuse + reflectedLight.indirectDiffuse + totalEmissiveRadiance;
	#include <envmap_fragment>
	#include <opaque_fragment>
	#include <tonemapping_fragment>
	#include <colorspace_fragment>
	#include <fog_fragment>
	#include <premultiplied_alpha_fragment>
	#include <dithering_fragment>
}`,Pd=`#define MATCAP
varying vec3 vViewPosition;
#include <common>
#include <batching_pars_vertex>
#include <uv_pars_vertex>
#include <color_pars_vertex>
#include <displacementmap_pars_vertex>
#include <fog_pars_vertex>
#include <normal_pars_vertex>
#include <morphtarget_pars_vertex>
#include <skinning_pars_vertex>
#include <logdepthbuf_pars_vertex>
#include <clipping_planes_pars_vertex>
void main() {
	#include <uv_vertex>
	#include <color_vertex>
	#include <morphinstance_vertex>
	#include <morphcolor_vertex>
	#include <batching_vertex>
	#include <beginnormal_vertex>
	#include <morphnormal_vertex>
	#include <skinbase_vertex>
	#include <skinnormal_vertex>
	#include <defaultnormal_vertex>
	#include <normal_vertex>
	#include <begin_vertex>
	#include <morphtarget_vertex>
	#include <skinning_vertex>
	#include <displacementmap_vertex>
	#include <project_vertex>
	#include <logdepthbuf_vertex>
	#include <clipping_planes_vertex>
	#include <fog_vertex>
	vViewPosition = - mvPosition.xyz;
}`,Ld=`#define MATCAP
uniform vec3 diffuse;
uniform float opacity;
uniform sampler2D matcap;
varying vec3 vViewPosition;
#include <common>
#include <dithering_pars_fragment>
#include <color_pars_fragment>
#include <uv_pars_fragment>
#include <map_pars_fragment>
#include <alphamap_pars_fragment>
#include <alphatest_pars_fragment>
#include <alphahash_pars_fragment>
#include <fog_pars_fragment>
#include <normal_pars_fragment>
#include <bumpmap_pars_fragment>
#include <normalmap_pars_fragment>
#include <logdepthbuf_pars_fragment>
#include <clipping_planes_pars_fragment>
void main() {
	vec4 diffuseColor = vec4( diffuse, opacity );
	#include <clipping_planes_fragment>
	#include <logdepthbuf_fragment>
	#include <map_fragment>
	#include <color_fragment>
	#include <alphamap_fragment>
	#include <alphatest_fragment>
	#include <alphahash_fragment>
	#include <normal_fragment_begin>
	#include <normal_fragment_maps>
	vec3 viewDir = normalize( vViewPosition );
	vec3 x = normalize( vec3( viewDir.z, 0.0, - viewDir.x ) );
	vec3 y = cross( viewDir, x );
	vec2 uv = vec2( dot( x, normal ), dot( y, normal ) ) * 0.495 + 0.5;
	#ifdef USE_MATCAP
		vec4 matcapColor = texture2D( matcap, uv );
	#else
		vec4 matcapColor = vec4( vec3( mix( 0.2, 0.8, uv.y ) ), 1.0 );
	#endif
	vec3 outgoingLight = diffuseColor.rgb * matcapColor.rgb;
	#include <opaque_fragment>
	#include <tonemapping_fragment>
	#include <colorspace_fragment>
	#include <fog_fragment>
	#include <premultiplied_alpha_fragment>
	#include <dithering_fragment>
}`,Dd=`#define NORMAL
#if defined( FLAT_SHADED ) || defined( USE_BUMPMAP ) || defined( USE_NORMALMAP_TANGENTSPACE )
	varying vec3 vViewPosition;
#endif
#include <common>
#include <batching_pars_vertex>
#include <uv_pars_vertex>
#include <displacementmap_pars_vertex>
#include <normal_pars_vertex>
#include <morphtarget_pars_vertex>
#include <skinning_pars_vertex>
#include <logdepthbuf_pars_vertex>
#include <clipping_planes_pars_vertex>
void main() {
	#include <uv_vertex>
	#include <batching_vertex>
	#include <beginnormal_vertex>
	#include <morphinstance_vertex>
	#include <morphnormal_vertex>
	#include <skinbase_vertex>
	#include <skinnormal_vertex>
	#include <defaultnormal_vertex>
	#include <normal_vertex>
	#include <begin_vertex>
	#include <morphtarget_vertex>
	#include <skinning_vertex>
	#include <displacementmap_vertex>
	#include <project_vertex>
	#include <logdepthbuf_vertex>
	#include <clipping_planes_vertex>
#if defined( FLAT_SHADED ) || defined( USE_BUMPMAP ) || defined( USE_NORMALMAP_TANGENTSPACE )
	vViewPosition = - mvPosition.xyz;
#endif
}`,Nd=`#define NORMAL
uniform float opacity;
#if defined( FLAT_SHADED ) || defined( USE_BUMPMAP ) || defined( USE_NORMALMAP_TANGENTSPACE )
	varying vec3 vViewPosition;
#endif
#include <uv_pars_fragment>
#include <normal_pars_fragment>
#include <bumpmap_pars_fragment>
#include <normalmap_pars_fragment>
#include <logdepthbuf_pars_fragment>
#include <clipping_planes_pars_fragment>
void main() {
	vec4 diffuseColor = vec4( 0.0, 0.0, 0.0, opacity );
	#include <clipping_planes_fragment>
	#include <logdepthbuf_fragment>
	#include <normal_fragment_begin>
	#include <normal_fragment_maps>
	gl_FragColor = vec4( normalize( normal ) * 0.5 + 0.5, diffuseColor.a );
	#ifdef OPAQUE
		gl_FragColor.a = 1.0;
	#endif
}`,Fd=`#define PHONG
varying vec3 vViewPosition;
#include <common>
#include <batching_pars_vertex>
#include <uv_pars_vertex>
#include <displacementmap_pars_vertex>
#include <envmap_pars_vertex>
#include <color_pars_vertex>
#include <fog_pars_vertex>
#include <normal_pars_vertex>
#include <morphtarget_pars_vertex>
#include <skinning_pars_vertex>
#include <shadowmap_pars_vertex>
#include <logdepthbuf_pars_vertex>
#include <clipping_planes_pars_vertex>
void main() {
	#include <uv_vertex>
	#include <color_vertex>
	#include <morphcolor_vertex>
	#include <batching_vertex>
	#include <beginnormal_vertex>
	#include <morphinstance_vertex>
	#include <morphnormal_vertex>
	#include <skinbase_vertex>
	#include <skinnormal_vertex>
	#include <defaultnormal_vertex>
	#include <normal_vertex>
	#include <begin_vertex>
	#include <morphtarget_vertex>
	#include <skinning_vertex>
	#include <displacementmap_vertex>
	#include <project_vertex>
	#include <logdepthbuf_vertex>
	#include <clipping_planes_vertex>
	vViewPosition = - mvPosition.xyz;
	#include <worldpos_vertex>
	#include <envmap_vertex>
	#include <shadowmap_vertex>
	#include <fog_vertex>
}`,Id=`#define PHONG
uniform vec3 diffuse;
uniform vec3 emissive;
uniform vec3 specular;
uniform float shininess;
uniform float opacity;
#include <common>
#include <dithering_pars_fragment>
#include <color_pars_fragment>
#include <uv_pars_fragment>
#include <map_pars_fragment>
#include <alphamap_pars_fragment>
#include <alphatest_pars_fragment>
#include <alphahash_pars_fragment>
#include <aomap_pars_fragment>
#include <lightmap_pars_fragment>
#include <emissivemap_pars_fragment>
#include <envmap_common_pars_fragment>
#include <envmap_pars_fragment>
#include <envmap_physical_pars_fragment>
#include <fog_pars_fragment>
#include <bsdfs>
#include <lights_pars_begin>
#include <normal_pars_fragment>
#include <lights_phong_pars_fragment>
#include <shadowmap_pars_fragment>
#include <bumpmap_pars_fragment>
#include <normalmap_pars_fragment>
#include <specularmap_pars_fragment>
#include <logdepthbuf_pars_fragment>
#include <clipping_planes_pars_fragment>
void main() {
	vec4 diffuseColor = vec4( diffuse, opacity );
	#include <clipping_planes_fragment>
	ReflectedLight reflectedLight = ReflectedLight( vec3( 0.0 ), vec3( 0.0 ), vec3( 0.0 ), vec3( 0.0 ) );
	vec3 totalEmissiveRadiance = emissive;
	#include <logdepthbuf_fragment>
	#include <map_fragment>
	#include <color_fragment>
	#include <alphamap_fragment>
	#include <alphatest_fragment>
	#include <alphahash_fragment>
	#include <specularmap_fragment>
	#include <normal_fragment_begin>
	#include <normal_fragment_maps>
	#include <emissivemap_fragment>
	#include <lights_phong_fragment>
	#include <lights_fragment_begin>
	#include <lights_fragment_maps>
	#include <lights_fragment_end>
	#include <aomap_fragment>
	vec3 outgoingLight = reflectedLight.directDiffuse + reflectedLight.indirectDiffuse + reflectedLight.directSpecular + reflectedLight.indirectSpecular + totalEmissiveRadiance;
	#include <envmap_fragment>
	#include <opaque_fragment>
	#include <tonemapping_fragment>
	#include <colorspace_fragment>
	#include <fog_fragment>
	#include <premultiplied_alpha_fragment>
	#include <dithering_fragment>
}`,Ud=`#define STANDARD
varying vec3 vViewPosition;
#ifdef USE_TRANSMISSION
	varying vec3 vWorldPosition;
#endif
#include <common>
#include <batching_pars_vertex>
#include <uv_pars_vertex>
#include <displacementmap_pars_vertex>
#include <color_pars_vertex>
#include <fog_pars_vertex>
#include <normal_pars_vertex>
#include <morphtarget_pars_vertex>
#include <skinning_pars_vertex>
#include <shadowmap_pars_vertex>
#include <logdepthbuf_pars_vertex>
#include <clipping_planes_pars_vertex>
void main() {
	#include <uv_vertex>
	#include <color_vertex>
	#include <morphinstance_vertex>
	#include <morphcolor_vertex>
	#include <batching_vertex>
	#include <beginnormal_vertex>
	#include <morphnormal_vertex>
	#include <skinbase_vertex>
	#include <skinnormal_vertex>
	#include <defaultnormal_vertex>
	#include <normal_vertex>
	#include <begin_vertex>
	#include <morphtarget_vertex>
	#include <skinning_vertex>
	#include <displacementmap_vertex>
	#include <project_vertex>
	#include <logdepthbuf_vertex>
	#include <clipping_planes_vertex>
	vViewPosition = - mvPosition.xyz;
	#include <worldpos_vertex>
	#include <shadowmap_vertex>
	#include <fog_vertex>
#ifdef USE_TRANSMISSION
	vWorldPosition = worldPosition.xyz;
#endif
}`,Od=`#define STANDARD
#ifdef PHYSICAL
	#define IOR
	#define USE_SPECULAR
#endif
uniform vec3 diffuse;
uniform vec3 emissive;
uniform float roughness;
uniform float metalness;
uniform float opacity;
#ifdef IOR
	uniform float ior;
#endif
#ifdef USE_SPECULAR
	uniform float specularIntensity;
	uniform vec3 specularColor;
	#ifdef USE_SPECULAR_COLORMAP
		uniform sampler2D specularColorMap;
	#endif
	#ifdef USE_SPECULAR_INTENSITYMAP
		uniform sampler2D specularIntensityMap;
	#endif
#endif
#ifdef USE_CLEARCOAT
	uniform float clearcoat;
	uniform float clearcoatRoughness;
#endif
#ifdef USE_DIFFUSE_ROUGHNESS
	uniform float diffuseRoughness;
	#ifdef USE_DIFFUSE_ROUGHNESSMAP
		uniform sampler2D diffuseRoughnessMap;
	#endif
#endif
#ifdef USE_DISPERSION
	uniform float dispersion;
#endif
#ifdef USE_RETROREFLECTION
	uniform float retroreflectivity;
#endif
#ifdef USE_IRIDESCENCE
	uniform float iridescence;
	uniform float iridescenceIOR;
	uniform float iridescenceThicknessMinimum;
	uniform float iridescenceThicknessMaximum;
#endif
#ifdef USE_SHEEN
	uniform vec3 sheenColor;
	uniform float sheenRoughness;
	#ifdef USE_SHEEN_COLORMAP
		uniform sampler2D sheenColorMap;
	#endif
	#ifdef USE_SHEEN_ROUGHNESSMAP
		uniform sampler2D sheenRoughnessMap;
	#endif
#endif
#ifdef USE_ANISOTROPY
	uniform vec2 anisotropyVector;
	#ifdef USE_ANISOTROPYMAP
		uniform sampler2D anisotropyMap;
	#endif
#endif
varying vec3 vViewPosition;
#include <common>
#include <dithering_pars_fragment>
#include <color_pars_fragment>
#include <uv_pars_fragment>
#include <map_pars_fragment>
#include <alphamap_pars_fragment>
#include <alphatest_pars_fragment>
#include <alphahash_pars_fragment>
#include <aomap_pars_fragment>
#include <lightmap_pars_fragment>
#include <emissivemap_pars_fragment>
#include <iridescence_fragment>
#include <envmap_common_pars_fragment>
#include <envmap_physical_pars_fragment>
#include <fog_pars_fragment>
#include <lights_pars_begin>
#include <normal_pars_fragment>
#include <lights_physical_pars_fragment>
#include <transmission_pars_fragment>
#include <shadowmap_pars_fragment>
#include <bumpmap_pars_fragment>
#include <normalmap_pars_fragment>
#include <clearcoat_pars_fragment>
#include <iridescence_pars_fragment>
#include <roughnessmap_pars_fragment>
#include <metalnessmap_pars_fragment>
#include <logdepthbuf_pars_fragment>
#include <clipping_planes_pars_fragment>
void main() {
	vec4 diffuseColor = vec4( diffuse, opacity );
	#include <clipping_planes_fragment>
	ReflectedLight reflectedLight = ReflectedLight( vec3( 0.0 ), vec3( 0.0 ), vec3( 0.0 ), vec3( 0.0 ) );
	vec3 totalEmissiveRadiance = emissive;
	#include <logdepthbuf_fragment>
	#include <map_fragment>
	#include <color_fragment>
	#include <alphamap_fragment>
	#include <alphatest_fragment>
	#include <alphahash_fragment>
	#include <roughnessmap_fragment>
	#include <metalnessmap_fragment>
	#include <normal_fragment_begin>
	#include <normal_fragment_maps>
	#include <clearcoat_normal_fragment_begin>
	#include <clearcoat_normal_fragment_maps>
	#include <emissivemap_fragment>
	#include <lights_physical_fragment>
	#include <lights_fragment_begin>
	#include <lights_fragment_maps>
	#include <lights_fragment_end>
	#include <aomap_fragment>
	vec3 totalDiffuse = reflectedLight.directDiffuse + reflectedLight.indirectDiffuse;
	vec3 totalSpecular = reflectedLight.directSpecular + reflectedLight.indirectSpecular;
	#include <transmission_fragment>
	vec3 outgoingLight = totalDiffuse + totalSpecular + totalEmissiveRadiance;
	#ifdef USE_SHEEN
 
		outgoingLight = outgoingLight + sheenSpecularDirect + sheenSpecularIndirect;
 
 	#endif
	#ifdef USE_CLEARCOAT
		float dotNVcc = saturate( dot( geometryClearcoatNormal, geometryViewDir ) );
		vec3 Fcc = F_Schlick( material.clearcoatF0, material.clearcoatF90, dotNVcc );
		outgoingLight = outgoingLight * ( 1.0 - material.clearcoat * Fcc ) + ( clearcoatSpecularDirect + clearcoatSpecularIndirect ) * material.clearcoat;
	#endif
	#include <opaque_fragment>
	#include <tonemapping_fragment>
	#include <colorspace_fragment>
	#include <fog_fragment>
	#include <premultiplied_alpha_fragment>
	#include <dithering_fragment>
}`,Bd=`#define TOON
varying vec3 vViewPosition;
#include <common>
#include <batching_pars_vertex>
#include <uv_pars_vertex>
#include <displacementmap_pars_vertex>
#include <color_pars_vertex>
#include <fog_pars_vertex>
#include <normal_pars_vertex>
#include <morphtarget_pars_vertex>
#include <skinning_pars_vertex>
#include <shadowmap_pars_vertex>
#include <logdepthbuf_pars_vertex>
#include <clipping_planes_pars_vertex>
void main() {
	#include <uv_vertex>
	#include <color_vertex>
	#include <morphinstance_vertex>
	#include <morphcolor_vertex>
	#include <batching_vertex>
	#include <beginnormal_vertex>
	#include <morphnormal_vertex>
	#include <skinbase_vertex>
	#include <skinnormal_vertex>
	#include <defaultnormal_vertex>
	#include <normal_vertex>
	#include <begin_vertex>
	#include <morphtarget_vertex>
	#include <skinning_vertex>
	#include <displacementmap_vertex>
	#include <project_vertex>
	#include <logdepthbuf_vertex>
	#include <clipping_planes_vertex>
	vViewPosition = - mvPosition.xyz;
	#include <worldpos_vertex>
	#include <shadowmap_vertex>
	#include <fog_vertex>
}`,kd=`#define TOON
uniform vec3 diffuse;
uniform vec3 emissive;
uniform float opacity;
#include <common>
#include <dithering_pars_fragment>
#include <color_pars_fragment>
#include <uv_pars_fragment>
#include <map_pars_fragment>
#include <alphamap_pars_fragment>
#include <alphatest_pars_fragment>
#include <alphahash_pars_fragment>
#include <aomap_pars_fragment>
#include <lightmap_pars_fragment>
#include <emissivemap_pars_fragment>
#include <gradientmap_pars_fragment>
#include <fog_pars_fragment>
#include <bsdfs>
#include <lights_pars_begin>
#include <normal_pars_fragment>
#include <lights_toon_pars_fragment>
#include <shadowmap_pars_fragment>
#include <bumpmap_pars_fragment>
#include <normalmap_pars_fragment>
#include <logdepthbuf_pars_fragment>
#include <clipping_planes_pars_fragment>
void main() {
	vec4 diffuseColor = vec4( diffuse, opacity );
	#include <clipping_planes_fragment>
	ReflectedLight reflectedLight = ReflectedLight( vec3( 0.0 ), vec3( 0.0 ), vec3( 0.0 ), vec3( 0.0 ) );
	vec3 totalEmissiveRadiance = emissive;
	#include <logdepthbuf_fragment>
	#include <map_fragment>
	#include <color_fragment>
	#include <alphamap_fragment>
	#include <alphatest_fragment>
	#include <alphahash_fragment>
	#include <normal_fragment_begin>
	#include <normal_fragment_maps>
	#include <emissivemap_fragment>
	#include <lights_toon_fragment>
	#include <lights_fragment_begin>
	#include <lights_fragment_maps>
	#include <lights_fragment_end>
	#include <aomap_fragment>
	vec3 outgoingLight = reflectedLight.directDiffuse + reflectedLight.indirectDiffuse + totalEmissiveRadiance;
	#include <opaque_fragment>
	#include <tonemapping_fragment>
	#include <colorspace_fragment>
	#include <fog_fragment>
	#include <premultiplied_alpha_fragment>
	#include <dithering_fragment>
}`,Gd=`uniform float size;
uniform float scale;
#include <common>
#include <color_pars_vertex>
#include <fog_pars_vertex>
#include <morphtarget_pars_vertex>
#include <logdepthbuf_pars_vertex>
#include <clipping_planes_pars_vertex>
#ifdef USE_POINTS_UV
	varying vec2 vUv;
	uniform mat3 uvTransform;
#endif
void main() {
	#ifdef USE_POINTS_UV
		vUv = ( uvTransform * vec3( uv, 1 ) ).xy;
	#endif
	#include <color_vertex>
	#include <morphinstance_vertex>
	#include <morphcolor_vertex>
	#include <begin_vertex>
	#include <morphtarget_vertex>
	#include <project_vertex>
	gl_PointSize = size;
	#ifdef USE_SIZEATTENUATION
		bool isPerspective = isPerspectiveMatrix( projectionMatrix );
		if ( isPerspective ) gl_PointSize *= ( scale / - mvPosition.z );
	#endif
	#include <logdepthbuf_vertex>
	#include <clipping_planes_vertex>
	#include <worldpos_vertex>
	#include <fog_vertex>
}`,zd=`uniform vec3 diffuse;
uniform float opacity;
#include <common>
#include <color_pars_fragment>
#include <map_particle_pars_fragment>
#include <alphatest_pars_fragment>
#include <alphahash_pars_fragment>
#include <fog_pars_fragment>
#include <logdepthbuf_pars_fragment>
#include <clipping_planes_pars_fragment>
void main() {
	vec4 diffuseColor = vec4( diffuse, opacity );
	#include <clipping_planes_fragment>
	vec3 outgoingLight = vec3( 0.0 );
	#include <logdepthbuf_fragment>
	#include <map_particle_fragment>
	#include <color_fragment>
	#include <alphatest_fragment>
	#include <alphahash_fragment>
	outgoingLight = diffuseColor.rgb;
	#include <opaque_fragment>
	#include <tonemapping_fragment>
	#include <colorspace_fragment>
	#include <fog_fragment>
	#include <premultiplied_alpha_fragment>
}`,Hd=`#include <common>
#include <batching_pars_vertex>
#include <fog_pars_vertex>
#include <morphtarget_pars_vertex>
#include <skinning_pars_vertex>
#include <logdepthbuf_pars_vertex>
#include <shadowmap_pars_vertex>
void main() {
	#include <batching_vertex>
	#include <beginnormal_vertex>
	#include <morphinstance_vertex>
	#include <morphnormal_vertex>
	#include <skinbase_vertex>
	#include <skinnormal_vertex>
	#include <defaultnormal_vertex>
	#include <begin_vertex>
	#include <morphtarget_vertex>
	#include <skinning_vertex>
	#include <project_vertex>
	#include <logdepthbuf_vertex>
	#include <worldpos_vertex>
	#include <shadowmap_vertex>
	#include <fog_vertex>
}`,Vd=`uniform vec3 color;
uniform float opacity;
#include <common>
#include <fog_pars_fragment>
#include <bsdfs>
#include <lights_pars_begin>
#include <logdepthbuf_pars_fragment>
#include <shadowmap_pars_fragment>
#include <shadowmask_pars_fragment>
void main() {
	#include <logdepthbuf_fragment>
	gl_FragColor = vec4( color, opacity * ( 1.0 - getShadowMask() ) );
	#include <tonemapping_fragment>
	#include <colorspace_fragment>
	#include <fog_fragment>
	#include <premultiplied_alpha_fragment>
}`,Wd=`uniform float rotation;
uniform vec2 center;
#include <common>
#include <uv_pars_vertex>
#include <fog_pars_vertex>
#include <logdepthbuf_pars_vertex>
#include <clipping_planes_pars_vertex>
void main() {
	#include <uv_vertex>
	vec4 mvPosition = modelViewMatrix[ 3 ];
	vec2 scale = vec2( length( modelMatrix[ 0 ].xyz ), length( modelMatrix[ 1 ].xyz ) );
	#ifndef USE_SIZEATTENUATION
		bool isPerspective = isPerspectiveMatrix( projectionMatrix );
		if ( isPerspective ) scale *= - mvPosition.z;
	#endif
	vec2 alignedPosition = ( position.xy - ( center - vec2( 0.5 ) ) ) * scale;
	vec2 rotatedPosition;
	rotatedPosition.x = cos( rotation ) * alignedPosition.x - sin( rotation ) * alignedPosition.y;
	rotatedPosition.y = sin( rotation ) * alignedPosition.x + cos( rotation ) * alignedPosition.y;
	mvPosition.xy += rotatedPosition;
	gl_Position = projectionMatrix * mvPosition;
	#include <logdepthbuf_vertex>
	#include <clipping_planes_vertex>
	#include <fog_vertex>
}`,Xd=`uniform vec3 diffuse;
uniform float opacity;
#include <common>
#include <uv_pars_fragment>
#include <map_pars_fragment>
#include <alphamap_pars_fragment>
#include <alphatest_pars_fragment>
#include <alphahash_pars_fragment>
#include <fog_pars_fragment>
#include <logdepthbuf_pars_fragment>
#include <clipping_planes_pars_fragment>
void main() {
	vec4 diffuseColor = vec4( diffuse, opacity );
	#include <clipping_planes_fragment>
	vec3 outgoingLight = vec3( 0.0 );
	#include <logdepthbuf_fragment>
	#include <map_fragment>
	#include <alphamap_fragment>
	#include <alphatest_fragment>
	#include <alphahash_fragment>
	outgoingLight = diffuseColor.rgb;
	#include <opaque_fragment>
	#include <tonemapping_fragment>
	#include <colorspace_fragment>
	#include <fog_fragment>
}`,Ge={alphahash_fragment:fc,alphahash_pars_fragment:pc,alphamap_fragment:mc,alphamap_pars_fragment:gc,alphatest_fragment:_c,alphatest_pars_fragment:vc,aomap_fragment:xc,aomap_pars_fragment:Sc,batching_pars_vertex:Mc,batching_vertex:wc,begin_vertex:yc,beginnormal_vertex:bc,bsdfs:Ec,iridescence_fragment:Tc,bumpmap_pars_fragment:Ac,clipping_planes_fragment:Rc,clipping_planes_pars_fragment:Cc,clipping_planes_pars_vertex:Pc,clipping_planes_vertex:Lc,color_fragment:Dc,color_pars_fragment:Nc,color_pars_vertex:Fc,color_vertex:Ic,common:Uc,defaultnormal_vertex:Oc,displacementmap_pars_vertex:Bc,displacementmap_vertex:kc,emissivemap_fragment:Gc,emissivemap_pars_fragment:zc,colorspace_fragment:Hc,colorspace_pars_fragment:Vc,envmap_fragment:Wc,envmap_common_pars_fragment:Xc,envmap_pars_fragment:$c,envmap_pars_vertex:qc,envmap_physical_pars_fragment:sh,envmap_vertex:Yc,fog_vertex:Kc,fog_pars_vertex:Zc,fog_fragment:Jc,fog_pars_fragment:Qc,gradientmap_pars_fragment:jc,lightmap_pars_fragment:eh,lights_lambert_fragment:th,lights_lambert_pars_fragment:nh,lights_pars_begin:ih,lights_toon_fragment:rh,lights_toon_pars_fragment:ah,lights_phong_fragment:oh,lights_phong_pars_fragment:lh,lights_physical_fragment:ch,lights_physical_pars_fragment:hh,lights_fragment_begin:dh,lights_fragment_maps:uh,lights_fragment_end:fh,lightprobes_pars_fragment:ph,logdepthbuf_fragment:mh,logdepthbuf_pars_fragment:gh,logdepthbuf_pars_vertex:_h,logdepthbuf_vertex:vh,map_fragment:xh,map_pars_fragment:Sh,map_particle_fragment:Mh,map_particle_pars_fragment:wh,metalnessmap_fragment:yh,metalnessmap_pars_fragment:bh,morphinstance_vertex:Eh,morphcolor_vertex:Th,morphnormal_vertex:Ah,morphtarget_pars_vertex:Rh,morphtarget_vertex:Ch,normal_fragment_begin:Ph,normal_fragment_maps:Lh,normal_pars_fragment:Dh,normal_pars_vertex:Nh,normal_vertex:Fh,normalmap_pars_fragment:Ih,clearcoat_normal_fragment_begin:Uh,clearcoat_normal_fragment_maps:Oh,clearcoat_pars_fragment:Bh,iridescence_pars_fragment:kh,opaque_fragment:Gh,packing:zh,premultiplied_alpha_fragment:Hh,project_vertex:Vh,dithering_fragment:Wh,dithering_pars_fragment:Xh,roughnessmap_fragment:$h,roughnessmap_pars_fragment:qh,shadowmap_pars_fragment:Yh,shadowmap_pars_vertex:Kh,shadowmap_vertex:Zh,shadowmask_pars_fragment:Jh,skinbase_vertex:Qh,skinning_pars_vertex:jh,skinning_vertex:ed,skinnormal_vertex:td,specularmap_fragment:nd,specularmap_pars_fragment:id,tonemapping_fragment:sd,tonemapping_pars_fragment:rd,transmission_fragment:ad,transmission_pars_fragment:od,uv_pars_fragment:ld,uv_pars_vertex:cd,uv_vertex:hd,worldpos_vertex:dd,background_vert:ud,background_frag:fd,backgroundCube_vert:pd,backgroundCube_frag:md,cube_vert:gd,cube_frag:_d,depth_vert:vd,depth_frag:xd,distance_vert:Sd,distance_frag:Md,equirect_vert:wd,equirect_frag:yd,linedashed_vert:bd,linedashed_frag:Ed,meshbasic_vert:Td,meshbasic_frag:Ad,meshlambert_vert:Rd,meshlambert_frag:Cd,meshmatcap_vert:Pd,meshmatcap_frag:Ld,meshnormal_vert:Dd,meshnormal_frag:Nd,meshphong_vert:Fd,meshphong_frag:Id,meshphysical_vert:Ud,meshphysical_frag:Od,meshtoon_vert:Bd,meshtoon_frag:kd,points_vert:Gd,points_frag:zd,shadow_vert:Hd,shadow_frag:Vd,sprite_vert:Wd,sprite_frag:Xd},ge={common:{diffuse:{value:new Xe(16777215)},opacity:{value:1},map:{value:null},mapTransform:{value:new Ue},alphaMap:{value:null},alphaMapTransform:{value:new Ue},alphaTest:{value:0}},specularmap:{specularMap:{value:null},specularMapTransform:{value:new Ue}},envmap:{envMap:{value:null},envMapRotation:{value:new Ue},reflectivity:{value:1},ior:{value:1.5},refractionRatio:{value:.98},dfgLUT:{value:null}},aomap:{aoMap:{value:null},aoMapIntensity:{value:1},aoMapTransform:{value:new Ue}},lightmap:{lightMap:{value:null},lightMapIntensity:{value:1},lightMapTransform:{value:new Ue}},bumpmap:{bumpMap:{value:null},bumpMapTransform:{value:new Ue},bumpScale:{value:1}},normalmap:{normalMap:{value:null},normalMapTransform:{value:new Ue},normalScale:{value:new Ye(1,1)}},displacementmap:{displacementMap:{value:null},displacementMapTransform:{value:new Ue},displacementScale:{value:1},displacementBias:{value:0}},emissivemap:{emissiveMap:{value:null},emissiveMapTransform:{value:new Ue}},metalnessmap:{metalnessMap:{value:null},metalnessMapTransform:{value:new Ue}},roughnessmap:{roughnessMap:{value:null},roughnessMapTransform:{value:new Ue}},gradientmap:{gradientMap:{value:null}},fog:{fogDensity:{value:25e-5},fogNear:{value:1},fogFar:{value:2e3},fogColor:{value:new Xe(16777215)}},lights:{ambientLightColor:{value:[]},lightProbe:{value:[]},sunLights:{value:[],properties:{direction:{},color:{}}},sunLightShadows:{value:[],properties:{shadowIntensity:1,shadowBias:{},shadowNormalBias:{},shadowRadius:{},shadowMapSize:{}}},sunShadowMatrix:{value:[]},sunShadowCascade:{value:[]},directionalLights:{value:[],properties:{direction:{},color:{}}},directionalLightShadows:{value:[],properties:{shadowIntensity:1,shadowBias:{},shadowNormalBias:{},shadowRadius:{},shadowMapSize:{}}},directionalShadowMatrix:{value:[]},spotLights:{value:[],properties:{color:{},position:{},direction:{},distance:{},coneCos:{},penumbraCos:{},decay:{}}},spotLightShadows:{value:[],properties:{shadowIntensity:1,shadowBias:{},shadowNormalBias:{},shadowRadius:{},shadowMapSize:{}}},spotLightMap:{value:[]},spotLightMatrix:{value:[]},pointLights:{value:[],properties:{color:{},position:{},decay:{},distance:{}}},pointLightShadows:{value:[],properties:{shadowIntensity:1,shadowBias:{},shadowNormalBias:{},shadowRadius:{},shadowMapSize:{},shadowCameraNear:{},shadowCameraFar:{}}},pointShadowMatrix:{value:[]},hemisphereLights:{value:[],properties:{direction:{},skyColor:{},groundColor:{}}},rectAreaLights:{value:[],properties:{color:{},position:{},width:{},height:{}}},ltc_1:{value:null},ltc_2:{value:null},probesSH:{value:[]},probesMin:{value:[]},probesMax:{value:[]},probesResolution:{value:[]}},points:{diffuse:{value:new Xe(16777215)},opacity:{value:1},size:{value:1},scale:{value:1},map:{value:null},alphaMap:{value:null},alphaMapTransform:{value:new Ue},alphaTest:{value:0},uvTransform:{value:new Ue}},sprite:{diffuse:{value:new Xe(16777215)},opacity:{value:1},center:{value:new Ye(.5,.5)},rotation:{value:0},map:{value:null},mapTransform:{value:new Ue},alphaMap:{value:null},alphaMapTransform:{value:new Ue},alphaTest:{value:0}}},hn={basic:{uniforms:Nt([ge.common,ge.specularmap,ge.envmap,ge.aomap,ge.lightmap,ge.fog]),vertexShader:Ge.meshbasic_vert,fragmentShader:Ge.meshbasic_frag},lambert:{uniforms:Nt([ge.common,ge.specularmap,ge.envmap,ge.aomap,ge.lightmap,ge.emissivemap,ge.bumpmap,ge.normalmap,ge.displacementmap,ge.fog,ge.lights,{emissive:{value:new Xe(0)},envMapIntensity:{value:1}}]),vertexShader:Ge.meshlambert_vert,fragmentShader:Ge.meshlambert_frag},phong:{uniforms:Nt([ge.common,ge.specularmap,ge.envmap,ge.aomap,ge.lightmap,ge.emissivemap,ge.bumpmap,ge.normalmap,ge.displacementmap,ge.fog,ge.lights,{emissive:{value:new Xe(0)},specular:{value:new Xe(1118481)},shininess:{value:30},envMapIntensity:{value:1}}]),vertexShader:Ge.meshphong_vert,fragmentShader:Ge.meshphong_frag},standard:{uniforms:Nt([ge.common,ge.envmap,ge.aomap,ge.lightmap,ge.emissivemap,ge.bumpmap,ge.normalmap,ge.displacementmap,ge.roughnessmap,ge.metalnessmap,ge.fog,ge.lights,{emissive:{value:new Xe(0)},roughness:{value:1},metalness:{value:0},envMapIntensity:{value:1}}]),vertexShader:Ge.meshphysical_vert,fragmentShader:Ge.meshphysical_frag},toon:{uniforms:Nt([ge.common,ge.aomap,ge.lightmap,ge.emissivemap,ge.bumpmap,ge.normalmap,ge.displacementmap,ge.gradientmap,ge.fog,ge.lights,{emissive:{value:new Xe(0)}}]),vertexShader:Ge.meshtoon_vert,fragmentShader:Ge.meshtoon_frag},matcap:{uniforms:Nt([ge.common,ge.bumpmap,ge.normalmap,ge.displacementmap,ge.fog,{matcap:{value:null}}]),vertexShader:Ge.meshmatcap_vert,fragmentShader:Ge.meshmatcap_frag},points:{uniforms:Nt([ge.points,ge.fog]),vertexShader:Ge.points_vert,fragmentShader:Ge.points_frag},dashed:{uniforms:Nt([ge.common,ge.fog,{scale:{value:1},dashSize:{value:1},totalSize:{value:2}}]),vertexShader:Ge.linedashed_vert,fragmentShader:Ge.linedashed_frag},depth:{uniforms:Nt([ge.common,ge.displacementmap]),vertexShader:Ge.depth_vert,fragmentShader:Ge.depth_frag},normal:{uniforms:Nt([ge.common,ge.bumpmap,ge.normalmap,ge.displacementmap,{opacity:{value:1}}]),vertexShader:Ge.meshnormal_vert,fragmentShader:Ge.meshnormal_frag},sprite:{uniforms:Nt([ge.sprite,ge.fog]),vertexShader:Ge.sprite_vert,fragmentShader:Ge.sprite_frag},background:{uniforms:{uvTransform:{value:new Ue},t2D:{value:null},backgroundIntensity:{value:1}},vertexShader:Ge.background_vert,fragmentShader:Ge.background_frag},backgroundCube:{uniforms:{envMap:{value:null},backgroundBlurriness:{value:0},backgroundIntensity:{value:1},backgroundRotation:{value:new Ue}},vertexShader:Ge.backgroundCube_vert,fragmentShader:Ge.backgroundCube_frag},cube:{uniforms:{tCube:{value:null},tFlip:{value:-1},opacity:{value:1}},vertexShader:Ge.cube_vert,fragmentShader:Ge.cube_frag},equirect:{uniforms:{tEquirect:{value:null}},vertexShader:Ge.equirect_vert,fragmentShader:Ge.equirect_frag},distance:{uniforms:Nt([ge.common,ge.displacementmap,{referencePosition:{value:new D},nearDistance:{value:1},farDistance:{value:1e3}}]),vertexShader:Ge.distance_vert,fragmentShader:Ge.distance_frag},shadow:{uniforms:Nt([ge.lights,ge.fog,{color:{value:new Xe(0)},opacity:{value:1}}]),vertexShader:Ge.shadow_vert,fragmentShader:Ge.shadow_frag}};hn.physical={uniforms:Nt([hn.standard.uniforms,{clearcoat:{value:0},clearcoatMap:{value:null},clearcoatMapTransform:{value:new Ue},clearcoatNormalMap:{value:null},clearcoatNormalMapTransform:{value:new Ue},clearcoatNormalScale:{value:new Ye(1,1)},clearcoatRoughness:{value:0},clearcoatRoughnessMap:{value:null},clearcoatRoughnessMapTransform:{value:new Ue},diffuseRoughness:{value:0},diffuseRoughnessMap:{value:null},diffuseRoughnessMapTransform:{value:new Ue},dispersion:{value:0},retroreflectivity:{value:0},iridescence:{value:0},iridescenceMap:{value:null},iridescenceMapTransform:{value:new Ue},iridescenceIOR:{value:1.3},iridescenceThicknessMinimum:{value:100},iridescenceThicknessMaximum:{value:400},iridescenceThicknessMap:{value:null},iridescenceThicknessMapTransform:{value:new Ue},sheen:{value:0},sheenColor:{value:new Xe(0)},sheenColorMap:{value:null},sheenColorMapTransform:{value:new Ue},sheenRoughness:{value:1},sheenRoughnessMap:{value:null},sheenRoughnessMapTransform:{value:new Ue},transmission:{value:0},transmissionMap:{value:null},transmissionMapTransform:{value:new Ue},transmissionSamplerSize:{value:new Ye},transmissionSamplerMap:{value:null},thickness:{value:0},thicknessMap:{value:null},thicknessMapTransform:{value:new Ue},attenuationDistance:{value:0},attenuationColor:{value:new Xe(0)},specularColor:{value:new Xe(1,1,1)},specularColorMap:{value:null},specularColorMapTransform:{value:new Ue},specularIntensity:{value:1},specularIntensityMap:{value:null},specularIntensityMapTransform:{value:new Ue},anisotropyVector:{value:new Ye},anisotropyMap:{value:null},anisotropyMapTransform:{value:new Ue}}]),vertexShader:Ge.meshphysical_vert,fragmentShader:Ge.meshphysical_frag};const gs={r:0,b:0,g:0},$d=new Qe,Ho=new Ue;Ho.set(-1,0,0,0,1,0,0,0,1);function qd(s,e,t,n,i,r){const a=new Xe(0);let o=i===!0?0:1,l,c,h=null,u=0,d=null;function f(M){let A=M.isScene===!0?M.background:null;if(A&&A.isTexture){const b=M.backgroundBlurriness>0;A=e.get(A,b)}return A}function g(M){let A=!1;const b=f(M);b===null?m(a,o):b&&b.isColor&&(m(b,1),A=!0);const R=s.xr.getEnvironmentBlendMode();R==="additive"?t.buffers.color.setClear(0,0,0,1,r):R==="alpha-blend"&&t.buffers.color.setClear(0,0,0,0,r),(s.autoClear||A)&&(t.buffers.depth.setTest(!0),t.buffers.depth.setMask(!0),t.buffers.color.setMask(!0),s.clear(s.autoClearColor,s.autoClearDepth,s.autoClearStencil))}function S(M,A){const b=f(A);b&&b.isCubeTexture?(c===void 0&&(c=new fn(new Mi(1,1,1),new pn({name:"BackgroundCubeMaterial",uniforms:mi(hn.backgroundCube.uniforms),vertexShader:hn.backgroundCube.vertexShader,fragmentShader:hn.backgroundCube.fragmentShader,side:1,depthTest:!1,depthWrite:!1,fog:!1,allowOverride:!1})),c.geometry.deleteAttribute("normal"),c.geometry.deleteAttribute("uv"),c.onBeforeRender=function(R,E,_){this.matrixWorld.copyPosition(_.matrixWorld)},Object.defineProperty(c.material,"envMap",{get:function(){return this.uniforms.envMap.value}}),n.update(c)),c.material.uniforms.envMap.value=b,c.material.uniforms.backgroundBlurriness.value=A.backgroundBlurriness,c.material.uniforms.backgroundIntensity.value=A.backgroundIntensity,c.material.uniforms.backgroundRotation.value.setFromMatrix4($d.makeRotationFromEuler(A.backgroundRotation)).transpose(),b.isRenderTargetTexture===!1&&c.material.uniforms.backgroundRotation.value.premultiply(Ho),c.material.toneMapped=qe.getTransfer(b.colorSpace)!==tt,(h!==b||u!==b.version||d!==s.toneMapping)&&(c.material.needsUpdate=!0,h=b,u=b.version,d=s.toneMapping),c.layers.enableAll(),M.unshift(c,c.geometry,c.material,0,0,null)):b&&b.isTexture&&(l===void 0&&(l=new fn(new Ws(2,2),new pn({name:"BackgroundMaterial",uniforms:mi(hn.background.uniforms),vertexShader:hn.background.vertexShader,fragmentShader:hn.background.fragmentShader,side:0,depthTest:!1,depthWrite:!1,fog:!1,allowOverride:!1})),l.geometry.deleteAttribute("normal"),Object.defineProperty(l.material,"map",{get:function(){return this.uniforms.t2D.value}}),n.update(l)),l.material.uniforms.t2D.value=b,l.material.uniforms.backgroundIntensity.value=A.backgroundIntensity,l.material.toneMapped=qe.getTransfer(b.colorSpace)!==tt,b.matrixAutoUpdate===!0&&b.updateMatrix(),l.material.uniforms.uvTransform.value.copy(b.matrix),(h!==b||u!==b.version||d!==s.toneMapping)&&(l.material.needsUpdate=!0,h=b,u=b.version,d=s.toneMapping),l.layers.enableAll(),M.unshift(l,l.geometry,l.material,0,0,null))}function m(M,A){M.getRGB(gs,Uo(s)),t.buffers.color.setClear(gs.r,gs.g,gs.b,A,r)}function p(){c!==void 0&&(c.geometry.dispose(),c.material.dispose(),c=void 0),l!==void 0&&(l.geometry.dispose(),l.material.dispose(),l=void 0)}return{getClearColor:function(){return a},setClearColor:function(M,A=1){a.set(M),o=A,m(a,o)},getClearAlpha:function(){return o},setClearAlpha:function(M){o=M,m(a,o)},render:g,addToRenderList:S,dispose:p}}function Yd(s,e){const t=s.getParameter(s.MAX_VERTEX_ATTRIBS),n={},i=d(null);let r=i,a=!1;function o(I,z,$,P,W){let Z=!1;const H=u(I,P,$,z);r!==H&&(r=H,c(r.object)),Z=f(I,P,$,W),Z&&g(I,P,$,W),W!==null&&e.update(W,s.ELEMENT_ARRAY_BUFFER),(Z||a)&&(a=!1,b(I,z,$,P),W!==null&&s.bindBuffer(s.ELEMENT_ARRAY_BUFFER,e.get(W).buffer))}function l(){return s.createVertexArray()}function c(I){return s.bindVertexArray(I)}function h(I){return s.deleteVertexArray(I)}function u(I,z,$,P){const W=P.wireframe===!0;let Z=n[z.id];Z===void 0&&(Z={},n[z.id]=Z);const H=I.isInstancedMesh===!0?I.id:0;let te=Z[H];te===void 0&&(te={},Z[H]=te);let V=te[$.id];V===void 0&&(V={},te[$.id]=V);let j=V[W];return j===void 0&&(j=d(l()),V[W]=j),j}function d(I){const z=[],$=[],P=[];for(let W=0;W<t;W++)z[W]=0,$[W]=0,P[W]=0;return{geometry:null,program:null,wireframe:!1,newAttributes:z,enabledAttributes:$,attributeDivisors:P,object:I,attributes:{},index:null}}function f(I,z,$,P){const W=r.attributes,Z=z.attributes;let H=0;const te=$.getAttributes();for(const V in te)if(te[V].location>=0){const ee=W[V];let we=Z[V];if(we===void 0&&(V==="instanceMatrix"&&I.instanceMatrix&&(we=I.instanceMatrix),V==="instanceColor"&&I.instanceColor&&(we=I.instanceColor)),ee===void 0||ee.attribute!==we||we&&ee.data!==we.data)return!0;H++}return r.attributesNum!==H||r.index!==P}function g(I,z,$,P){const W={},Z=z.attributes;let H=0;const te=$.getAttributes();for(const V in te)if(te[V].location>=0){let ee=Z[V];ee===void 0&&(V==="instanceMatrix"&&I.instanceMatrix&&(ee=I.instanceMatrix),V==="instanceColor"&&I.instanceColor&&(ee=I.instanceColor));const we={};we.attribute=ee,ee&&ee.data&&(we.data=ee.data),W[V]=we,H++}r.attributes=W,r.attributesNum=H,r.index=P}function S(){const I=r.newAttributes;for(let z=0,$=I.length;z<$;z++)I[z]=0}function m(I){p(I,0)}function p(I,z){const $=r.newAttributes,P=r.enabledAttributes,W=r.attributeDivisors;$[I]=1,P[I]===0&&(s.enableVertexAttribArray(I),P[I]=1),W[I]!==z&&(s.vertexAttribDivisor(I,z),W[I]=z)}function M(){const I=r.newAttributes,z=r.enabledAttributes;for(let $=0,P=z.length;$<P;$++)z[$]!==I[$]&&(s.disableVertexAttribArray($),z[$]=0)}function A(I,z,$,P,W,Z,H){H===!0?s.vertexAttribIPointer(I,z,$,W,Z):s.vertexAttribPointer(I,z,$,P,W,Z)}function b(I,z,$,P){S();const W=P.attributes,Z=$.getAttributes(),H=z.defaultAttributeValues;for(const te in Z){const V=Z[te];if(V.location>=0){let j=W[te];if(j===void 0&&(te==="instanceMatrix"&&I.instanceMatrix&&(j=I.instanceMatrix),te==="instanceColor"&&I.instanceColor&&(j=I.instanceColor)),j!==void 0){const ee=j.normalized,we=j.itemSize,Pe=e.get(j);if(Pe===void 0)continue;const q=Pe.buffer,he=Pe.type,ve=Pe.bytesPerElement,Ee=he===s.INT||he===s.UNSIGNED_INT||j.gpuType===1013;if(j.isInterleavedBufferAttribute){const fe=j.data,De=fe.isInterleavedBuffer===!0?fe.stride:fe.itemSize,Ke=j.offset;if(fe.isInstancedInterleavedBuffer||fe.isInstancedBufferAttribute){for(let Te=0;Te<V.locationSize;Te++)p(V.location+Te,fe.meshPerAttribute);I.isInstancedMesh!==!0&&P._maxInstanceCount===void 0&&(P._maxInstanceCount=fe.meshPerAttribute*fe.count)}else for(let Te=0;Te<V.locationSize;Te++)m(V.location+Te);s.bindBuffer(s.ARRAY_BUFFER,q);for(let Te=0;Te<V.locationSize;Te++)A(V.location+Te,we/V.locationSize,he,ee,De*ve,(Ke+we/V.locationSize*Te)*ve,Ee)}else{if(j.isInstancedBufferAttribute){for(let fe=0;fe<V.locationSize;fe++)p(V.location+fe,j.meshPerAttribute);I.isInstancedMesh!==!0&&P._maxInstanceCount===void 0&&(P._maxInstanceCount=j.meshPerAttribute*j.count)}else for(let fe=0;fe<V.locationSize;fe++)m(V.location+fe);s.bindBuffer(s.ARRAY_BUFFER,q);for(let fe=0;fe<V.locationSize;fe++)A(V.location+fe,we/V.locationSize,he,ee,we*ve,we/V.locationSize*fe*ve,Ee)}}else if(H!==void 0){const ee=H[te];if(ee!==void 0)switch(ee.length){case 2:s.vertexAttrib2fv(V.location,ee);break;case 3:s.vertexAttrib3fv(V.location,ee);break;case 4:s.vertexAttrib4fv(V.location,ee);break;default:s.vertexAttrib1fv(V.location,ee)}}}}M()}function R(){k();for(const I in n){const z=n[I];for(const $ in z){const P=z[$];for(const W in P){const Z=P[W];for(const H in Z)h(Z[H].object),delete Z[H];delete P[W]}}delete n[I]}}function E(I){if(n[I.id]===void 0)return;const z=n[I.id];for(const $ in z){const P=z[$];for(const W in P){const Z=P[W];for(const H in Z)h(Z[H].object),delete Z[H];delete P[W]}}delete n[I.id]}function _(I){for(const z in n){const $=n[z];for(const P in $){const W=$[P];if(W[I.id]===void 0)continue;const Z=W[I.id];for(const H in Z)h(Z[H].object),delete Z[H];delete W[I.id]}}}function y(I){for(const z in n){const $=n[z],P=I.isInstancedMesh===!0?I.id:0,W=$[P];if(W!==void 0){for(const Z in W){const H=W[Z];for(const te in H)h(H[te].object),delete H[te];delete W[Z]}delete $[P],Object.keys($).length===0&&delete n[z]}}}function k(){N(),a=!0,r!==i&&(r=i,c(r.object))}function N(){i.geometry=null,i.program=null,i.wireframe=!1}return{setup:o,reset:k,resetDefaultState:N,dispose:R,releaseStatesOfGeometry:E,releaseStatesOfObject:y,releaseStatesOfProgram:_,initAttributes:S,enableAttribute:m,disableUnusedAttributes:M}}function Kd(s,e,t){let n;function i(l){n=l}function r(l,c){s.drawArrays(n,l,c),t.update(c,n,1)}function a(l,c,h){h!==0&&(s.drawArraysInstanced(n,l,c,h),t.update(c,n,h))}function o(l,c,h){if(h===0)return;e.get("WEBGL_multi_draw").multiDrawArraysWEBGL(n,l,0,c,0,h);let d=0;for(let f=0;f<h;f++)d+=c[f];t.update(d,n,1)}this.setMode=i,this.render=r,this.renderInstances=a,this.renderMultiDraw=o}function Zd(s,e,t,n){let i;function r(){if(i!==void 0)return i;if(e.has("EXT_texture_filter_anisotropic")===!0){const _=e.get("EXT_texture_filter_anisotropic");i=s.getParameter(_.MAX_TEXTURE_MAX_ANISOTROPY_EXT)}else i=0;return i}function a(_){return!(_!==1023&&n.convert(_)!==s.getParameter(s.IMPLEMENTATION_COLOR_READ_FORMAT))}function o(_){const y=_===1016&&(e.has("EXT_color_buffer_half_float")||e.has("EXT_color_buffer_float"));return!(_!==1009&&_!==1015&&!y&&n.convert(_)!==s.getParameter(s.IMPLEMENTATION_COLOR_READ_TYPE))}function l(_){if(_==="highp"){if(s.getShaderPrecisionFormat(s.VERTEX_SHADER,s.HIGH_FLOAT).precision>0&&s.getShaderPrecisionFormat(s.FRAGMENT_SHADER,s.HIGH_FLOAT).precision>0)return"highp";_="mediump"}return _==="mediump"&&s.getShaderPrecisionFormat(s.VERTEX_SHADER,s.MEDIUM_FLOAT).precision>0&&s.getShaderPrecisionFormat(s.FRAGMENT_SHADER,s.MEDIUM_FLOAT).precision>0?"mediump":"lowp"}let c=t.precision!==void 0?t.precision:"highp";const h=l(c);h!==c&&(Le("WebGLRenderer:",c,"not supported, using",h,"instead."),c=h);const u=t.reversedDepthBuffer===!0&&e.has("EXT_clip_control"),d=t.logarithmicDepthBuffer===!0&&u===!1;t.reversedDepthBuffer===!0&&u===!1&&Le("WebGLRenderer: Unable to use reversed depth buffer due to missing EXT_clip_control extension. Fallback to default depth buffer."),t.logarithmicDepthBuffer===!0&&u===!0&&Le("WebGLRenderer: Logarithmic depth buffer is ignored when reversed depth buffer is enabled.");const f=s.getParameter(s.MAX_TEXTURE_IMAGE_UNITS),g=s.getParameter(s.MAX_VERTEX_TEXTURE_IMAGE_UNITS),S=s.getParameter(s.MAX_TEXTURE_SIZE),m=s.getParameter(s.MAX_CUBE_MAP_TEXTURE_SIZE),p=s.getParameter(s.MAX_VERTEX_ATTRIBS),M=s.getParameter(s.MAX_VERTEX_UNIFORM_VECTORS),A=s.getParameter(s.MAX_VARYING_VECTORS),b=s.getParameter(s.MAX_FRAGMENT_UNIFORM_VECTORS),R=s.getParameter(s.MAX_SAMPLES),E=s.getParameter(s.SAMPLES);return{isWebGL2:!0,getMaxAnisotropy:r,getMaxPrecision:l,textureFormatReadable:a,textureTypeReadable:o,precision:c,logarithmicDepthBuffer:d,reversedDepthBuffer:u,maxTextures:f,maxVertexTextures:g,maxTextureSize:S,maxCubemapSize:m,maxAttributes:p,maxVertexUniforms:M,maxVaryings:A,maxFragmentUniforms:b,maxSamples:R,samples:E}}function Jd(s){const e=this;let t=null,n=0,i=!1,r=!1;const a=new wn,o=new Ue,l={value:null,needsUpdate:!1};this.uniform=l,this.numPlanes=0,this.numIntersection=0,this.init=function(u,d){const f=u.length!==0||d||n!==0||i;return i=d,n=u.length,f},this.beginShadows=function(){r=!0,h(null)},this.endShadows=function(){r=!1},this.setGlobalState=function(u,d){t=h(u,d,0)},this.setState=function(u,d,f){const g=u.clippingPlanes,S=u.clipIntersection,m=u.clipShadows,p=s.get(u);if(!i||g===null||g.length===0||r&&!m)r?h(null):c();else{const M=r?0:n,A=M*4;let b=p.clippingState||null;l.value=b,b=h(g,d,A,f);for(let R=0;R!==A;++R)b[R]=t[R];p.clippingState=b,this.numIntersection=S?this.numPlanes:0,this.numPlanes+=M}};function c(){l.value!==t&&(l.value=t,l.needsUpdate=n>0),e.numPlanes=n,e.numIntersection=0}function h(u,d,f,g){const S=u!==null?u.length:0;let m=null;if(S!==0){if(m=l.value,g!==!0||m===null){const p=f+S*4,M=d.matrixWorldInverse;o.getNormalMatrix(M),(m===null||m.length<p)&&(m=new Float32Array(p));for(let A=0,b=f;A!==S;++A,b+=4)a.copy(u[A]).applyMatrix4(M,o),a.normal.toArray(m,b),m[b+3]=a.constant}l.value=m,l.needsUpdate=!0}return e.numPlanes=S,e.numIntersection=0,m}}class Xr extends Zt{constructor(e=1,t={}){super(e,e,t),this.isWebGLCubeRenderTarget=!0;const n={width:e,height:e,depth:1},i=[n,n,n,n,n,n];this.texture=new No(i),this._setTextureOptions(t),this.texture.isRenderTargetTexture=!0}fromEquirectangularTexture(e,t){this.texture.type=t.type,this.texture.colorSpace=t.colorSpace,this.texture.generateMipmaps=t.generateMipmaps,this.texture.minFilter=t.minFilter,this.texture.magFilter=t.magFilter;const n={uniforms:{tEquirect:{value:null}},vertexShader:`

				varying vec3 vWorldDirection;

				vec3 transformDirection( in vec3 dir, in mat4 matrix ) {

					return normalize( ( matrix * vec4( dir, 0.0 ) ).xyz );

				}

				void main() {

					vWorldDirection = transformDirection( position, modelMatrix );

					#include <begin_vertex>
					#include <project_vertex>

				}
			`,fragmentShader:`

				uniform sampler2D tEquirect;

				varying vec3 vWorldDirection;

				#include <common>

				void main() {

					vec3 direction = normalize( vWorldDirection );

					vec2 sampleUV = equirectUv( direction );

					gl_FragColor = texture2D( tEquirect, sampleUV );

				}
			`},i=new Mi(5,5,5),r=new pn({name:"CubemapFromEquirect",uniforms:mi(n.uniforms),vertexShader:n.vertexShader,fragmentShader:n.fragmentShader,side:1,blending:0});r.uniforms.tEquirect.value=t;const a=new fn(i,r),o=t.minFilter;return t.minFilter===1008&&(t.minFilter=1006),new Dr(1,10,this).update(e,a),t.minFilter=o,a.geometry.dispose(),a.material.dispose(),this}clear(e,t=!0,n=!0,i=!0){const r=e.getRenderTarget();for(let a=0;a<6;a++)e.setRenderTarget(this,a),e.clear(t,n,i);e.setRenderTarget(r)}}const ka=256,Qd=3,jd=20,Vo=256,Wo=16,eu=3,tu=new D,nu=new Xe;class Us{constructor(e){this._renderer=e,this._cubeSize=0,this._sourceTarget=null,this._cubeCamera=new Dr(1,10,null),this._boxMesh=new fn(new Mi(5,5,5),null),this._cubemapMaterial=null,this._equirectMaterial=null,this._blurMaterial=null,this._ggxMaterial=null,this._integrationMaterial=null}fromScene(e,t=0,n=.1,i=100,r={}){const{size:a=256,position:o=tu}=r,l=this._renderer;this._setSize(a);const c=this._allocateTarget(),h=this._getSourceTarget(!0);t>0&&(h.texture.mipmapsAutoUpdate=!1);const u=l.autoClear,d=l.autoClearColor,f=l.autoClearDepth,g=l.autoClearStencil,S=e.background;l.autoClear=!0,l.autoClearColor=!0,l.autoClearDepth=!0,l.autoClearStencil=!0,S===null&&(e.background=l.getClearColor(nu));const m=new Dr(n,i,h);return m.position.copy(o),m.update(l,e),l.autoClear=u,l.autoClearColor=d,l.autoClearDepth=f,l.autoClearStencil=g,e.background=S,t>0&&(h.texture.mipmapsAutoUpdate=!0,this._blur(c,t)),this._applyPMREM(c),c}fromEquirectangular(e,t=null){return this._fromTexture(e,t)}fromCubemap(e,t=null){return this._fromTexture(e,t)}compileCubemapShader(){this._cubemapMaterial===null&&(this._cubemapMaterial=Ha(),this._compileMaterial(this._cubemapMaterial))}compileEquirectangularShader(){this._equirectMaterial===null&&(this._equirectMaterial=za(),this._compileMaterial(this._equirectMaterial))}dispose(){this._sourceTarget!==null&&this._sourceTarget.dispose(),this._cubemapMaterial!==null&&this._cubemapMaterial.dispose(),this._equirectMaterial!==null&&this._equirectMaterial.dispose(),this._blurMaterial!==null&&this._blurMaterial.dispose(),this._ggxMaterial!==null&&this._ggxMaterial.dispose(),this._integrationMaterial!==null&&this._integrationMaterial.dispose(),this._boxMesh.geometry.dispose()}static lodToRoughness(e,t){return t>0?1-Math.sqrt(1-e/t):0}_setSize(e){this._cubeSize=Math.max(ka,Cl(e))}_fromTexture(e,t){e.mapping===301||e.mapping===302?this._setSize(e.image.length===0?ka:e.image[0].width||e.image[0].image.width):this._setSize(e.image.width/4);const n=t||this._allocateTarget();return this._textureToCubemap(e),this._applyPMREM(n),n}_allocateTarget(){const e=this._cubeSize,t=Ga(e,!1,!1),n=Math.log2(e)-Qd;for(let i=0;i<=n;i++)t.texture.mipmaps.push({width:e>>i,height:e>>i});return t.texture.name="PMREM",t.texture.isPMREMTexture=!0,t}_getSourceTarget(e=!1){const t=this._cubeSize,n=this._sourceTarget;return(n===null||n.width!==t||e&&n.depthBuffer===!1)&&(n!==null&&n.dispose(),this._sourceTarget=Ga(t,!0,e)),this._sourceTarget}_compileMaterial(e){this._boxMesh.material=e,this._renderer.compile(this._boxMesh,this._cubeCamera.children[0])}_renderCube(e,t,n){const i=this._boxMesh,r=this._cubeCamera;i.material=n,r.renderTarget=e,r.activeMipmapLevel=t;const a=e.width>>t;e.viewport.set(0,0,a,a),r.update(this._renderer,i),e.viewport.set(0,0,e.width,e.height)}_textureToCubemap(e){let t;e.mapping===301||e.mapping===302?(this._cubemapMaterial===null&&(this._cubemapMaterial=Ha()),t=this._cubemapMaterial,t.uniforms.flipEnvMap.value=e.isRenderTargetTexture===!1?-1:1):(this._equirectMaterial===null&&(this._equirectMaterial=za()),t=this._equirectMaterial),t.uniforms.envMap.value=e,this._renderCube(this._getSourceTarget(),0,t)}_applyPMREM(e){this._ggxMaterial===null&&(this._ggxMaterial=iu(),this._integrationMaterial=su());const t=this._cubeSize,n=e.texture.mipmaps.length-1,i=this._ggxMaterial.uniforms;i.envMap.value=this._sourceTarget.texture;const r=this._integrationMaterial.uniforms;r.envMap.value=this._sourceTarget.texture,r.sourceLod.value=Math.log2(t/Wo);for(let a=0;a<=n;a++){const o=Us.lodToRoughness(a,n);if(a>n-eu)r.roughness.value=o,this._renderCube(e,a,this._integrationMaterial);else{const l=o>0?Math.log2(t)+.5*Math.log2(6/(Vo*Math.pow(o,4)))+.5:0;i.roughness.value=o,i.lodBias.value=l,this._renderCube(e,a,this._ggxMaterial)}}}_blur(e,t){this._blurMaterial===null&&(this._blurMaterial=ru());const n=this._blurMaterial,i=n.uniforms,r=this._sourceTarget;i.sigma.value=Math.min(t,Math.PI)/Math.SQRT2,i.envMap.value=r.texture,this._renderCube(e,0,n),i.envMap.value=e.texture,this._renderCube(r,0,n)}}function Ga(s,e,t){return new Xr(s,{minFilter:1008,generateMipmaps:e,type:1016,colorSpace:Ls,depthBuffer:t})}function Vi(s,e,t){return new pn({name:s,uniforms:e,vertexShader:Ge.cube_vert,fragmentShader:t,side:1,blending:0,depthTest:!1,depthWrite:!1})}function iu(){return Vi("PMREMGGXConvolution",{envMap:{value:null},roughness:{value:0},lodBias:{value:0}},`

		#define GGX_SAMPLES ${Vo}u

		varying vec3 vWorldDirection;

		uniform samplerCube envMap;
		uniform float roughness;
		uniform float lodBias;

		#include <common>

		// Van der Corput radical inverse
		float radicalInverse_VdC( uint bits ) {

			bits = ( bits << 16u ) | ( bits >> 16u );
			bits = ( ( bits & 0x55555555u ) << 1u ) | ( ( bits & 0xAAAAAAAAu ) >> 1u );
			bits = ( ( bits & 0x33333333u ) << 2u ) | ( ( bits & 0xCCCCCCCCu ) >> 2u );
			bits = ( ( bits & 0x0F0F0F0Fu ) << 4u ) | ( ( bits & 0xF0F0F0F0u ) >> 4u );
			bits = ( ( bits & 0x00FF00FFu ) << 8u ) | ( ( bits & 0xFF00FF00u ) >> 8u );
			return float( bits ) * 2.3283064365386963e-10; // / 0x100000000

		}

		// Hammersley sequence
		vec2 hammersley( uint i, uint N ) {

			return vec2( float( i ) / float( N ), radicalInverse_VdC( i ) );

		}

		void main() {

			vec3 N = normalize( vWorldDirection );

			// For very low roughness, just sample the environment directly
			if ( roughness < 0.001 ) {

				gl_FragColor = vec4( textureLod( envMap, N, 0.0 ).rgb, 1.0 );
				return;

			}

			float alpha = roughness * roughness;
			float alpha2 = alpha * alpha;

			// Tangent space basis for VNDF sampling
			vec3 up = abs( N.z ) < 0.999 ? vec3( 0.0, 0.0, 1.0 ) : vec3( 1.0, 0.0, 0.0 );
			vec3 tangent = normalize( cross( up, N ) );
			vec3 bitangent = cross( N, tangent );

			vec3 prefilteredColor = vec3( 0.0 );
			float totalWeight = 0.0;

			for ( uint i = 0u; i < GGX_SAMPLES; i ++ ) {

				vec2 Xi = hammersley( i, GGX_SAMPLES );

				// With V = N, sample the reflected direction directly.
				float invQ = 1.0 / ( 1.0 - Xi.x + alpha2 * Xi.x );
				float NdotL = ( 1.0 - Xi.x - alpha2 * Xi.x ) * invQ;

				if ( NdotL > 0.0 ) {

					float phi = 2.0 * PI * Xi.y;
					float sinTheta = 2.0 * alpha * sqrt( Xi.x * ( 1.0 - Xi.x ) ) * invQ;
					vec3 L = N * NdotL + ( tangent * cos( phi ) + bitangent * sin( phi ) ) * sinTheta;

					// Match the source mip to the sample's solid angle. The terms
					// independent of the sample are precomputed in lodBias.
					float d = alpha2 * invQ;
					float lod = max( log2( d ) + lodBias, 0.0 );

					// Weight by NdotL for the split-sum approximation
					prefilteredColor += textureLod( envMap, L, lod ).rgb * NdotL;
					totalWeight += NdotL;

				}

			}

			gl_FragColor = vec4( prefilteredColor / totalWeight, 1.0 );

		}
	`)}function su(){return Vi("PMREMGGXIntegration",{envMap:{value:null},roughness:{value:0},sourceLod:{value:0},sourceSize:{value:Wo}},`

		varying vec3 vWorldDirection;

		uniform samplerCube envMap;
		uniform float roughness;
		uniform float sourceLod;
		uniform int sourceSize;

		void main() {

			vec3 N = normalize( vWorldDirection );

			float alpha = roughness * roughness;
			float alpha2 = alpha * alpha;

			float texelSize = 2.0 / float( sourceSize );

			vec3 prefilteredColor = vec3( 0.0 );
			float totalWeight = 0.0;

			// Pair opposite texels: only the one in N's hemisphere contributes.
			for ( int face = 0; face < 3; face ++ ) {

				for ( int y = 0; y < sourceSize; y ++ ) {

					for ( int x = 0; x < sourceSize; x ++ ) {

						vec2 uv = ( vec2( x, y ) + 0.5 ) * texelSize - 1.0;
						vec3 texelDirection = face == 0 ? vec3( 1.0, uv ) : ( face == 1 ? vec3( uv.x, 1.0, uv.y ) : vec3( uv, 1.0 ) );

						float invDistance = inversesqrt( 1.0 + dot( uv, uv ) );
						float NdotL = dot( N, texelDirection );
						texelDirection *= NdotL < 0.0 ? - 1.0 : 1.0;
						NdotL = abs( NdotL ) * invDistance;

						// With V = N, NdotH squared is ( 1 + NdotL ) / 2. Common factors
						// in the GGX distribution and texel solid angle cancel when normalized.
						float d = 1.0 + alpha2 + ( alpha2 - 1.0 ) * NdotL;
						float weight = NdotL * invDistance * invDistance * invDistance / ( d * d );

						prefilteredColor += textureLod( envMap, texelDirection, sourceLod ).rgb * weight;
						totalWeight += weight;

					}

				}

			}

			gl_FragColor = vec4( prefilteredColor / totalWeight, 1.0 );

		}
	`)}function ru(){return Vi("PMREMSphericalGaussianBlur",{envMap:{value:null},sigma:{value:0}},`

		#define SAMPLES ${jd}
		#define GOLDEN_ANGLE 2.39996322973

		varying vec3 vWorldDirection;

		uniform samplerCube envMap;
		uniform float sigma;

		#include <common>

		void main() {

			vec3 outputDirection = normalize( vWorldDirection );

			vec3 up = abs( outputDirection.z ) < 0.999 ? vec3( 0.0, 0.0, 1.0 ) : vec3( 1.0, 0.0, 0.0 );
			vec3 tangent = normalize( cross( up, outputDirection ) );
			vec3 bitangent = cross( outputDirection, tangent );

			// Truncate the kernel at three standard deviations or at the antipode.
			float thetaMax = min( 3.0 * sigma, PI );
			float truncation = 1.0 - exp( - 0.5 * thetaMax * thetaMax / ( sigma * sigma ) );

			vec3 accumColor = vec3( 0.0 );
			float accumWeight = 0.0;

			for ( int i = 0; i < SAMPLES; i ++ ) {

				// Stratified inverse-CDF sampling of the Gaussian, placed on a golden-angle spiral.
				float stratum = ( float( i ) + 0.5 ) / float( SAMPLES );
				float theta = sigma * sqrt( - 2.0 * log( 1.0 - stratum * truncation ) );
				float phi = float( i ) * GOLDEN_ANGLE;

				vec3 offset = cos( phi ) * tangent + sin( phi ) * bitangent;
				vec3 sampleDirection = cos( theta ) * outputDirection + sin( theta ) * offset;

				// Correct the planar sample density to solid angle.
				float weight = sin( theta ) / theta;

				accumColor += weight * textureLod( envMap, sampleDirection, 0.0 ).rgb;
				accumWeight += weight;

			}

			gl_FragColor = vec4( accumColor / accumWeight, 1.0 );

		}
	`)}function za(){return Vi("PMREMEquirectangularToCubemap",{envMap:{value:null}},`

		varying vec3 vWorldDirection;

		uniform sampler2D envMap;

		#include <common>

		void main() {

			// Average four subpixel samples to preserve small, bright features.
			vec3 direction = normalize( vWorldDirection );
			vec3 dx = dFdx( direction ) * 0.25;
			vec3 dy = dFdy( direction ) * 0.25;

			vec3 color = textureLod( envMap, equirectUv( normalize( direction - dx - dy ) ), 0.0 ).rgb;
			color += textureLod( envMap, equirectUv( normalize( direction + dx - dy ) ), 0.0 ).rgb;
			color += textureLod( envMap, equirectUv( normalize( direction - dx + dy ) ), 0.0 ).rgb;
			color += textureLod( envMap, equirectUv( normalize( direction + dx + dy ) ), 0.0 ).rgb;
			gl_FragColor = vec4( color * 0.25, 1.0 );

		}
	`)}function Ha(){return Vi("PMREMCubemapToCubemap",{envMap:{value:null},flipEnvMap:{value:-1}},`

		varying vec3 vWorldDirection;

		uniform samplerCube envMap;
		uniform float flipEnvMap;

		void main() {

			gl_FragColor = vec4( textureCube( envMap, vec3( flipEnvMap * vWorldDirection.x, vWorldDirection.yz ) ).rgb, 1.0 );

		}
	`)}function au(s){let e=new WeakMap,t=new WeakMap,n=null;function i(d,f=!1){return d==null?null:f?a(d):r(d)}function r(d){if(d&&d.isTexture){const f=d.mapping;if(f===303||f===304)if(e.has(d)){const g=e.get(d).texture;return o(g,d.mapping)}else{const g=d.image;if(g&&g.height>0){const S=new Xr(g.height);return S.fromEquirectangularTexture(s,d),e.set(d,S),d.addEventListener("dispose",c),o(S.texture,d.mapping)}else return null}}return d}function a(d){if(d&&d.isTexture&&d.isPMREMTexture!==!0){const f=d.mapping,g=f===303||f===304,S=f===301||f===302;if(g||S){let m=t.get(d);const p=m!==void 0?m.texture.pmremVersion:0;if(d.isRenderTargetTexture&&d.pmremVersion!==p)return n===null&&(n=new Us(s)),m=g?n.fromEquirectangular(d,m):n.fromCubemap(d,m),m.texture.pmremVersion=d.pmremVersion,t.set(d,m),m.texture;if(m!==void 0)return m.texture;{const M=d.image;return g&&M&&M.height>0||S&&M&&l(M)?(n===null&&(n=new Us(s)),m=g?n.fromEquirectangular(d):n.fromCubemap(d),m.texture.pmremVersion=d.pmremVersion,t.set(d,m),d.addEventListener("dispose",h),m.texture):null}}}return d}function o(d,f){return f===303?d.mapping=301:f===304&&(d.mapping=302),d}function l(d){let f=0;const g=6;for(let S=0;S<g;S++)d[S]!==void 0&&f++;return f===g}function c(d){const f=d.target;f.removeEventListener("dispose",c);const g=e.get(f);g!==void 0&&(e.delete(f),g.dispose())}function h(d){const f=d.target;f.removeEventListener("dispose",h);const g=t.get(f);g!==void 0&&(t.delete(f),g.dispose())}function u(){e=new WeakMap,t=new WeakMap,n!==null&&(n.dispose(),n=null)}return{get:i,dispose:u}}function ou(s){const e={};function t(n){if(e[n]!==void 0)return e[n];const i=s.getExtension(n);return e[n]=i,i}return{has:function(n){return t(n)!==null},init:function(){t("EXT_color_buffer_float"),t("WEBGL_clip_cull_distance"),t("OES_texture_float_linear"),t("EXT_color_buffer_half_float"),t("WEBGL_multisampled_render_to_texture"),t("WEBGL_render_shared_exponent")},get:function(n){const i=t(n);return i===null&&Ts("WebGLRenderer: "+n+" extension not supported."),i}}}function lu(s,e,t,n){const i={},r=new WeakMap,a=new FinalizationRegistry(g=>delete i[g]);function o(g){l(g.target)}function l(g){g.index!==null&&e.remove(g.index);for(const m in g.attributes)e.remove(g.attributes[m]);g.removeEventListener("dispose",o),delete i[g.id],a.unregister(g);const S=r.get(g);S&&(e.remove(S),r.delete(g)),n.releaseStatesOfGeometry(g),g.isInstancedBufferGeometry===!0&&delete g._maxInstanceCount,t.memory.geometries--}function c(g,S){return i[S.id]!==void 0||(S.addEventListener("dispose",o),i[S.id]=new WeakRef(S),a.register(S,S.id,S),t.memory.geometries++),S}function h(g){const S=g.attributes;for(const m in S)e.update(S[m],s.ARRAY_BUFFER)}function u(g){const S=g.index,m=g.attributes.position;let p=0;if(m===void 0)return;const M=S!==null?S.array.length:m.array.length/3-1,A=m.count>=65535?Do:Lo,b=new A(Math.ceil(M/3)*6,1),R=b.array;if(S!==null){const _=S.array;p=S.version;for(let y=0,k=0;y<M;y+=3){const N=_[y+0],I=_[y+1],z=_[y+2];R[k++]=N,R[k++]=I,R[k++]=I,R[k++]=z,R[k++]=z,R[k++]=N}}else{p=m.version;for(let _=0,y=0;_<M;_+=3){const k=_+0,N=_+1,I=_+2;R[y++]=k,R[y++]=N,R[y++]=N,R[y++]=I,R[y++]=I,R[y++]=k}}b.version=p;const E=r.get(g);E&&e.remove(E),r.set(g,b)}function d(g){const S=r.get(g);if(S){const m=g.index;m!==null&&S.version<m.version&&u(g)}else u(g);return r.get(g)}function f(){for(const g in i){const S=i[g].deref();S!==void 0&&l(S)}}return{get:c,update:h,getWireframeAttribute:d,dispose:f}}function cu(s,e,t){let n;function i(u){n=u}let r,a;function o(u){r=u.type,a=u.bytesPerElement}function l(u,d){s.drawElements(n,d,r,u*a),t.update(d,n,1)}function c(u,d,f){f!==0&&(s.drawElementsInstanced(n,d,r,u*a,f),t.update(d,n,f))}function h(u,d,f){if(f===0)return;e.get("WEBGL_multi_draw").multiDrawElementsWEBGL(n,d,0,r,u,0,f);let S=0;for(let m=0;m<f;m++)S+=d[m];t.update(S,n,1)}this.setMode=i,this.setIndex=o,this.render=l,this.renderInstances=c,this.renderMultiDraw=h}function hu(s){const e={geometries:0,textures:0},t={frame:0,calls:0,triangles:0,points:0,lines:0};function n(r,a,o){switch(t.calls++,a){case s.TRIANGLES:t.triangles+=o*(r/3);break;case s.LINES:t.lines+=o*(r/2);break;case s.LINE_STRIP:t.lines+=o*(r-1);break;case s.LINE_LOOP:t.lines+=o*r;break;case s.POINTS:t.points+=o*r;break;default:Je("WebGLInfo: Unknown draw mode:",a);break}}function i(){t.calls=0,t.triangles=0,t.points=0,t.lines=0}return{memory:e,render:t,programs:null,autoReset:!0,reset:i,update:n}}function du(s,e,t){const n=new WeakMap,i=new gt;function r(a,o,l){const c=a.morphTargetInfluences,h=o.morphAttributes.position||o.morphAttributes.normal||o.morphAttributes.color,u=h!==void 0?h.length:0;let d=n.get(o);if(d===void 0||d.count!==u){let k=function(){_.dispose(),n.delete(o),o.removeEventListener("dispose",k)};d!==void 0&&d.texture.dispose();const f=o.morphAttributes.position!==void 0,g=o.morphAttributes.normal!==void 0,S=o.morphAttributes.color!==void 0,m=o.morphAttributes.position||[],p=o.morphAttributes.normal||[],M=o.morphAttributes.color||[];let A=0;f===!0&&(A=1),g===!0&&(A=2),S===!0&&(A=3);let b=o.attributes.position.count*A,R=1;b>e.maxTextureSize&&(R=Math.ceil(b/e.maxTextureSize),b=e.maxTextureSize);const E=new Float32Array(b*R*4*u),_=new Co(E,b,R,u);_.type=1015,_.needsUpdate=!0;const y=A*4;for(let N=0;N<u;N++){const I=m[N],z=p[N],$=M[N],P=b*R*4*N;for(let W=0;W<I.count;W++){const Z=W*y;f===!0&&(i.fromBufferAttribute(I,W),E[P+Z+0]=i.x,E[P+Z+1]=i.y,E[P+Z+2]=i.z,E[P+Z+3]=0),g===!0&&(i.fromBufferAttribute(z,W),E[P+Z+4]=i.x,E[P+Z+5]=i.y,E[P+Z+6]=i.z,E[P+Z+7]=0),S===!0&&(i.fromBufferAttribute($,W),E[P+Z+8]=i.x,E[P+Z+9]=i.y,E[P+Z+10]=i.z,E[P+Z+11]=$.itemSize===4?i.w:1)}}d={count:u,texture:_,size:new Ye(b,R)},n.set(o,d),o.addEventListener("dispose",k)}if(a.isInstancedMesh===!0&&a.morphTexture!==null)l.getUniforms().setValue(s,"morphTexture",a.morphTexture,t);else{let f=0;for(let S=0;S<c.length;S++)f+=c[S];const g=o.morphTargetsRelative?1:1-f;l.getUniforms().setValue(s,"morphTargetBaseInfluence",g),l.getUniforms().setValue(s,"morphTargetInfluences",c)}l.getUniforms().setValue(s,"morphTargetsTexture",d.texture,t),l.getUniforms().setValue(s,"morphTargetsTextureSize",d.size)}return{update:r}}function uu(s,e,t,n,i){let r=new WeakMap;function a(c){const h=i.render.frame,u=c.geometry,d=e.get(c,u);if(r.get(d)!==h&&(e.update(d),r.set(d,h)),c.isInstancedMesh&&(c.hasEventListener("dispose",l)===!1&&c.addEventListener("dispose",l),r.get(c)!==h&&(t.update(c.instanceMatrix,s.ARRAY_BUFFER),c.instanceColor!==null&&t.update(c.instanceColor,s.ARRAY_BUFFER),r.set(c,h))),c.isSkinnedMesh){const f=c.skeleton;r.get(f)!==h&&(f.update(),r.set(f,h))}return d}function o(){r=new WeakMap}function l(c){const h=c.target;h.removeEventListener("dispose",l),n.releaseStatesOfObject(h),t.remove(h.instanceMatrix),h.instanceColor!==null&&t.remove(h.instanceColor)}return{update:a,dispose:o}}const fu={1:"LINEAR_TONE_MAPPING",2:"REINHARD_TONE_MAPPING",3:"CINEON_TONE_MAPPING",4:"ACES_FILMIC_TONE_MAPPING",6:"AGX_TONE_MAPPING",7:"NEUTRAL_TONE_MAPPING",5:"CUSTOM_TONE_MAPPING"};function pu(s,e,t,n,i,r){const a=new Zt(e,t,{type:s,depthBuffer:i,stencilBuffer:r,samples:n?4:0,storeMultisampledDepthBuffer:!1,storeMultisampledStencilBuffer:!1,resolveDepthBuffer:!1,resolveStencilBuffer:!1});let o=null,l=null,c=null;const h=new ht;h.setAttribute("position",new Jt([-1,3,0,-1,-1,0,3,-1,0],3)),h.setAttribute("uv",new Jt([0,2,0,0,2,0],2));const u=new rc({uniforms:{tDiffuse:{value:null}},vertexShader:`
			precision highp float;

			uniform mat4 modelViewMatrix;
			uniform mat4 projectionMatrix;

			attribute vec3 position;
			attribute vec2 uv;

			varying vec2 vUv;

			void main() {
				vUv = uv;
				gl_Position = projectionMatrix * modelViewMatrix * vec4( position, 1.0 );
			}`,fragmentShader:`
			precision highp float;

			uniform sampler2D tDiffuse;

			varying vec2 vUv;

			#include <tonemapping_pars_fragment>
			#include <colorspace_pars_fragment>

			void main() {
				gl_FragColor = texture2D( tDiffuse, vUv );

				#ifdef LINEAR_TONE_MAPPING
					gl_FragColor.rgb = LinearToneMapping( gl_FragColor.rgb );
				#elif defined( REINHARD_TONE_MAPPING )
					gl_FragColor.rgb = ReinhardToneMapping( gl_FragColor.rgb );
				#elif defined( CINEON_TONE_MAPPING )
					gl_FragColor.rgb = CineonToneMapping( gl_FragColor.rgb );
				#elif defined( ACES_FILMIC_TONE_MAPPING )
					gl_FragColor.rgb = ACESFilmicToneMapping( gl_FragColor.rgb );
				#elif defined( AGX_TONE_MAPPING )
					gl_FragColor.rgb = AgXToneMapping( gl_FragColor.rgb );
				#elif defined( NEUTRAL_TONE_MAPPING )
					gl_FragColor.rgb = NeutralToneMapping( gl_FragColor.rgb );
				#elif defined( CUSTOM_TONE_MAPPING )
					gl_FragColor.rgb = CustomToneMapping( gl_FragColor.rgb );
				#endif

				#ifdef SRGB_TRANSFER
					gl_FragColor = sRGBTransferOETF( gl_FragColor );
				#endif
			}`,depthTest:!1,depthWrite:!1}),d=new fn(h,u),f=new Bo(-1,1,1,-1,0,1);let g=null,S=null,m=!1,p,M=null,A=[],b=!1;this.setSize=function(R,E){a.setSize(R,E),o!==null&&o.setSize(R,E),l!==null&&l.setSize(R,E);for(let _=0;_<A.length;_++){const y=A[_];y.setSize&&y.setSize(R,E)}},this.setEffects=function(R){A=R,b=A.length>0&&A[0].isRenderPass===!0;const E=a.width,_=a.height;A.length>0&&o===null&&(o=new Zt(E,_,{type:1016,depthBuffer:!1,stencilBuffer:!1}),l=new Zt(E,_,{type:1016,depthBuffer:!1,stencilBuffer:!1}));const y=i===!0&&A.some(k=>k.needsDepthTexture===!0);y!==(a.depthTexture!==null)&&(y===!0&&c===null&&(c=new Zn(E,_),r===!0&&(c.format=1027,c.type=1020)),a.dispose(),a.depthTexture=y?c:null,a.resolveDepthBuffer=y,a.storeMultisampledDepthBuffer=y);for(let k=0;k<A.length;k++){const N=A[k];N.setSize&&N.setSize(E,_),y&&N.needsDepthTexture===!0&&N.setDepthTexture&&N.setDepthTexture(c)}},this.begin=function(R,E){if(m||R.toneMapping===0&&A.length===0)return!1;if(M=E,E!==null){const _=E.width,y=E.height;(a.width!==_||a.height!==y)&&this.setSize(_,y)}return b===!1&&R.setRenderTarget(a),p=R.toneMapping,R.toneMapping=0,!0},this.hasRenderPass=function(){return b},this.end=function(R,E){R.toneMapping=p,m=!0;let _=a,y=o;for(let k=0;k<A.length;k++){const N=A[k];N.enabled!==!1&&(N.render(R,y,_,E),N.needsSwap!==!1&&(_=y,y=y===o?l:o))}if(g!==R.outputColorSpace||S!==R.toneMapping){g=R.outputColorSpace,S=R.toneMapping,u.defines={},qe.getTransfer(g)===tt&&(u.defines.SRGB_TRANSFER="");const k=fu[S];k&&(u.defines[k]=""),u.needsUpdate=!0}u.uniforms.tDiffuse.value=_.texture,R.setRenderTarget(M),R.render(d,f),M=null,m=!1},this.isCompositing=function(){return m},this.dispose=function(){a.dispose(),o!==null&&o.dispose(),l!==null&&l.dispose(),h.dispose(),u.dispose()}}const Xo=new Ft,$o=new Zn(1,1),qo=new Fo(1),Yo=new Co,Ko=new Ol,Zo=new No,Va=[],Wa=[],Xa=new Float32Array(16),$a=new Float32Array(9),qa=new Float32Array(4);function wi(s,e,t){const n=s[0];if(n<=0||n>0)return s;const i=e*t;let r=Va[i];if(r===void 0&&(r=new Float32Array(i),Va[i]=r),e!==0){n.toArray(r,0);for(let a=1,o=0;a!==e;++a)o+=t,s[a].toArray(r,o)}return r}function xt(s,e){if(s.length!==e.length)return!1;for(let t=0,n=s.length;t<n;t++)if(s[t]!==e[t])return!1;return!0}function St(s,e){for(let t=0,n=e.length;t<n;t++)s[t]=e[t]}function Xs(s,e){let t=Wa[e];t===void 0&&(t=new Int32Array(e),Wa[e]=t);for(let n=0;n!==e;++n)t[n]=s.allocateTextureUnit();return t}function mu(s,e){const t=this.cache;t[0]!==e&&(s.uniform1f(this.addr,e),t[0]=e)}function gu(s,e){const t=this.cache;if(e.x!==void 0)(t[0]!==e.x||t[1]!==e.y)&&(s.uniform2f(this.addr,e.x,e.y),t[0]=e.x,t[1]=e.y);else{if(xt(t,e))return;s.uniform2fv(this.addr,e),St(t,e)}}function _u(s,e){const t=this.cache;if(e.x!==void 0)(t[0]!==e.x||t[1]!==e.y||t[2]!==e.z)&&(s.uniform3f(this.addr,e.x,e.y,e.z),t[0]=e.x,t[1]=e.y,t[2]=e.z);else if(e.r!==void 0)(t[0]!==e.r||t[1]!==e.g||t[2]!==e.b)&&(s.uniform3f(this.addr,e.r,e.g,e.b),t[0]=e.r,t[1]=e.g,t[2]=e.b);else{if(xt(t,e))return;s.uniform3fv(this.addr,e),St(t,e)}}function vu(s,e){const t=this.cache;if(e.x!==void 0)(t[0]!==e.x||t[1]!==e.y||t[2]!==e.z||t[3]!==e.w)&&(s.uniform4f(this.addr,e.x,e.y,e.z,e.w),t[0]=e.x,t[1]=e.y,t[2]=e.z,t[3]=e.w);else{if(xt(t,e))return;s.uniform4fv(this.addr,e),St(t,e)}}function xu(s,e){const t=this.cache,n=e.elements;if(n===void 0){if(xt(t,e))return;s.uniformMatrix2fv(this.addr,!1,e),St(t,e)}else{if(xt(t,n))return;qa.set(n),s.uniformMatrix2fv(this.addr,!1,qa),St(t,n)}}function Su(s,e){const t=this.cache,n=e.elements;if(n===void 0){if(xt(t,e))return;s.uniformMatrix3fv(this.addr,!1,e),St(t,e)}else{if(xt(t,n))return;$a.set(n),s.uniformMatrix3fv(this.addr,!1,$a),St(t,n)}}function Mu(s,e){const t=this.cache,n=e.elements;if(n===void 0){if(xt(t,e))return;s.uniformMatrix4fv(this.addr,!1,e),St(t,e)}else{if(xt(t,n))return;Xa.set(n),s.uniformMatrix4fv(this.addr,!1,Xa),St(t,n)}}function wu(s,e){const t=this.cache;t[0]!==e&&(s.uniform1i(this.addr,e),t[0]=e)}function yu(s,e){const t=this.cache;if(e.x!==void 0)(t[0]!==e.x||t[1]!==e.y)&&(s.uniform2i(this.addr,e.x,e.y),t[0]=e.x,t[1]=e.y);else{if(xt(t,e))return;s.uniform2iv(this.addr,e),St(t,e)}}function bu(s,e){const t=this.cache;if(e.x!==void 0)(t[0]!==e.x||t[1]!==e.y||t[2]!==e.z)&&(s.uniform3i(this.addr,e.x,e.y,e.z),t[0]=e.x,t[1]=e.y,t[2]=e.z);else{if(xt(t,e))return;s.uniform3iv(this.addr,e),St(t,e)}}function Eu(s,e){const t=this.cache;if(e.x!==void 0)(t[0]!==e.x||t[1]!==e.y||t[2]!==e.z||t[3]!==e.w)&&(s.uniform4i(this.addr,e.x,e.y,e.z,e.w),t[0]=e.x,t[1]=e.y,t[2]=e.z,t[3]=e.w);else{if(xt(t,e))return;s.uniform4iv(this.addr,e),St(t,e)}}function Tu(s,e){const t=this.cache;t[0]!==e&&(s.uniform1ui(this.addr,e),t[0]=e)}function Au(s,e){const t=this.cache;if(e.x!==void 0)(t[0]!==e.x||t[1]!==e.y)&&(s.uniform2ui(this.addr,e.x,e.y),t[0]=e.x,t[1]=e.y);else{if(xt(t,e))return;s.uniform2uiv(this.addr,e),St(t,e)}}function Ru(s,e){const t=this.cache;if(e.x!==void 0)(t[0]!==e.x||t[1]!==e.y||t[2]!==e.z)&&(s.uniform3ui(this.addr,e.x,e.y,e.z),t[0]=e.x,t[1]=e.y,t[2]=e.z);else{if(xt(t,e))return;s.uniform3uiv(this.addr,e),St(t,e)}}function Cu(s,e){const t=this.cache;if(e.x!==void 0)(t[0]!==e.x||t[1]!==e.y||t[2]!==e.z||t[3]!==e.w)&&(s.uniform4ui(this.addr,e.x,e.y,e.z,e.w),t[0]=e.x,t[1]=e.y,t[2]=e.z,t[3]=e.w);else{if(xt(t,e))return;s.uniform4uiv(this.addr,e),St(t,e)}}function $s(s){return s.version===0&&(s.compareFunction=519,s.needsUpdate=!0),s}function Pu(s,e,t){const n=this.cache,i=t.allocateTextureUnit();n[0]!==i&&(s.uniform1i(this.addr,i),n[0]=i);let r;this.type===s.SAMPLER_2D_SHADOW?r=$s($o):r=Xo,t.setTexture2D(e||r,i)}function Lu(s,e,t){const n=this.cache,i=t.allocateTextureUnit();n[0]!==i&&(s.uniform1i(this.addr,i),n[0]=i),t.setTexture3D(e||Ko,i)}function Du(s,e,t){const n=this.cache,i=t.allocateTextureUnit();n[0]!==i&&(s.uniform1i(this.addr,i),n[0]=i);let r;this.type===s.SAMPLER_CUBE_SHADOW?r=$s(qo):r=Zo,t.setTextureCube(e||r,i)}function Nu(s,e,t){const n=this.cache,i=t.allocateTextureUnit();n[0]!==i&&(s.uniform1i(this.addr,i),n[0]=i),t.setTexture2DArray(e||Yo,i)}function Fu(s){switch(s){case 5126:return mu;case 35664:return gu;case 35665:return _u;case 35666:return vu;case 35674:return xu;case 35675:return Su;case 35676:return Mu;case 5124:case 35670:return wu;case 35667:case 35671:return yu;case 35668:case 35672:return bu;case 35669:case 35673:return Eu;case 5125:return Tu;case 36294:return Au;case 36295:return Ru;case 36296:return Cu;case 35678:case 36198:case 36298:case 36306:case 35682:return Pu;case 35679:case 36299:case 36307:return Lu;case 35680:case 36300:case 36308:case 36293:return Du;case 36289:case 36303:case 36311:case 36292:return Nu}}function Iu(s,e){s.uniform1fv(this.addr,e)}function Uu(s,e){const t=wi(e,this.size,2);s.uniform2fv(this.addr,t)}function Ou(s,e){const t=wi(e,this.size,3);s.uniform3fv(this.addr,t)}function Bu(s,e){const t=wi(e,this.size,4);s.uniform4fv(this.addr,t)}function ku(s,e){const t=wi(e,this.size,4);s.uniformMatrix2fv(this.addr,!1,t)}function Gu(s,e){const t=wi(e,this.size,9);s.uniformMatrix3fv(this.addr,!1,t)}function zu(s,e){const t=wi(e,this.size,16);s.uniformMatrix4fv(this.addr,!1,t)}function Hu(s,e){s.uniform1iv(this.addr,e)}function Vu(s,e){s.uniform2iv(this.addr,e)}function Wu(s,e){s.uniform3iv(this.addr,e)}function Xu(s,e){s.uniform4iv(this.addr,e)}function $u(s,e){s.uniform1uiv(this.addr,e)}function qu(s,e){s.uniform2uiv(this.addr,e)}function Yu(s,e){s.uniform3uiv(this.addr,e)}function Ku(s,e){s.uniform4uiv(this.addr,e)}function Zu(s,e,t){const n=this.cache,i=e.length,r=Xs(t,i);xt(n,r)||(s.uniform1iv(this.addr,r),St(n,r));let a;this.type===s.SAMPLER_2D_SHADOW?a=$s($o):a=Xo;for(let o=0;o!==i;++o)t.setTexture2D(e[o]||a,r[o])}function Ju(s,e,t){const n=this.cache,i=e.length,r=Xs(t,i);xt(n,r)||(s.uniform1iv(this.addr,r),St(n,r));for(let a=0;a!==i;++a)t.setTexture3D(e[a]||Ko,r[a])}function Qu(s,e,t){const n=this.cache,i=e.length,r=Xs(t,i);xt(n,r)||(s.uniform1iv(this.addr,r),St(n,r));let a;this.type===s.SAMPLER_CUBE_SHADOW?a=$s(qo):a=Zo;for(let o=0;o!==i;++o)t.setTextureCube(e[o]||a,r[o])}function ju(s,e,t){const n=this.cache,i=e.length,r=Xs(t,i);xt(n,r)||(s.uniform1iv(this.addr,r),St(n,r));for(let a=0;a!==i;++a)t.setTexture2DArray(e[a]||Yo,r[a])}function ef(s){switch(s){case 5126:return Iu;case 35664:return Uu;case 35665:return Ou;case 35666:return Bu;case 35674:return ku;case 35675:return Gu;case 35676:return zu;case 5124:case 35670:return Hu;case 35667:case 35671:return Vu;case 35668:case 35672:return Wu;case 35669:case 35673:return Xu;case 5125:return $u;case 36294:return qu;case 36295:return Yu;case 36296:return Ku;case 35678:case 36198:case 36298:case 36306:case 35682:return Zu;case 35679:case 36299:case 36307:return Ju;case 35680:case 36300:case 36308:case 36293:return Qu;case 36289:case 36303:case 36311:case 36292:return ju}}class tf{constructor(e,t,n){this.id=e,this.addr=n,this.cache=[],this.type=t.type,this.setValue=Fu(t.type)}}class nf{constructor(e,t,n){this.id=e,this.addr=n,this.cache=[],this.type=t.type,this.size=t.size,this.setValue=ef(t.type)}}class sf{constructor(e){this.id=e,this.seq=[],this.map={}}setValue(e,t,n){const i=this.seq;for(let r=0,a=i.length;r!==a;++r){const o=i[r];o.setValue(e,t[o.id],n)}}}const Mr=/(\w+)(\])?(\[|\.)?/g;function Ya(s,e){s.seq.push(e),s.map[e.id]=e}function rf(s,e,t){const n=s.name,i=n.length;for(Mr.lastIndex=0;;){const r=Mr.exec(n),a=Mr.lastIndex;let o=r[1];const l=r[2]==="]",c=r[3];if(l&&(o=o|0),c===void 0||c==="["&&a+2===i){Ya(t,c===void 0?new tf(o,s,e):new nf(o,s,e));break}else{let u=t.map[o];u===void 0&&(u=new sf(o),Ya(t,u)),t=u}}}class As{constructor(e,t){this.seq=[],this.map={};const n=e.getProgramParameter(t,e.ACTIVE_UNIFORMS);for(let a=0;a<n;++a){const o=e.getActiveUniform(t,a),l=e.getUniformLocation(t,o.name);rf(o,l,this)}const i=[],r=[];for(const a of this.seq)a.type===e.SAMPLER_2D_SHADOW||a.type===e.SAMPLER_CUBE_SHADOW||a.type===e.SAMPLER_2D_ARRAY_SHADOW?i.push(a):r.push(a);i.length>0&&(this.seq=i.concat(r))}setValue(e,t,n,i){const r=this.map[t];r!==void 0&&r.setValue(e,n,i)}setOptional(e,t,n){const i=t[n];i!==void 0&&this.setValue(e,n,i)}static upload(e,t,n,i){for(let r=0,a=t.length;r!==a;++r){const o=t[r],l=n[o.id];l.needsUpdate!==!1&&o.setValue(e,l.value,i)}}static seqWithValue(e,t){const n=[];for(let i=0,r=e.length;i!==r;++i){const a=e[i];a.id in t&&n.push(a)}return n}}function Ka(s,e,t){const n=s.createShader(e);return s.shaderSource(n,t),s.compileShader(n),n}const af=37297;let of=0;function lf(s,e){const t=s.split(`
`),n=[],i=Math.max(e-6,0),r=Math.min(e+6,t.length);for(let a=i;a<r;a++){const o=a+1;n.push(`${o===e?">":" "} ${o}: ${t[a]}`)}return n.join(`
`)}const Za=new Ue;function cf(s){qe._getMatrix(Za,qe.workingColorSpace,s);const e=`mat3( ${Za.elements.map(t=>t.toFixed(4))} )`;switch(qe.getTransfer(s)){case Ds:return[e,"LinearTransferOETF"];case tt:return[e,"sRGBTransferOETF"];default:return Le("WebGLProgram: Unsupported color space: ",s),[e,"LinearTransferOETF"]}}function Ja(s,e,t){const n=s.getShaderParameter(e,s.COMPILE_STATUS),r=(s.getShaderInfoLog(e)||"").trim();if(n&&r==="")return"";const a=/ERROR: 0:(\d+)/.exec(r);if(a){const o=parseInt(a[1]);return t.toUpperCase()+`

`+r+`

`+lf(s.getShaderSource(e),o)}else return r}function hf(s,e){const t=cf(e);return[`vec4 ${s}( vec4 value ) {`,`	return ${t[1]}( vec4( ${t[0]} * value.rgb, value.a ) );`,"}"].join(`
`)}const df={1:"Linear",2:"Reinhard",3:"Cineon",4:"ACESFilmic",6:"AgX",7:"Neutral",5:"Custom"};function uf(s,e){const t=df[e];return t===void 0?(Le("WebGLProgram: Unsupported toneMapping:",e),"vec3 "+s+"( vec3 color ) { return LinearToneMapping( color ); }"):"vec3 "+s+"( vec3 color ) { return "+t+"ToneMapping( color ); }"}const _s=new D;function ff(){qe.getLuminanceCoefficients(_s);const s=_s.x.toFixed(4),e=_s.y.toFixed(4),t=_s.z.toFixed(4);return["float luminance( const in vec3 rgb ) {",`	const vec3 weights = vec3( ${s}, ${e}, ${t} );`,"	return dot( weights, rgb );","}"].join(`
`)}function pf(s){return[s.extensionClipCullDistance?"#extension GL_ANGLE_clip_cull_distance : require":"",s.extensionMultiDraw?"#extension GL_ANGLE_multi_draw : require":""].filter(Ni).join(`
`)}function mf(s){const e=[];for(const t in s){const n=s[t];n!==!1&&e.push("#define "+t+" "+n)}return e.join(`
`)}function gf(s,e){const t={},n=s.getProgramParameter(e,s.ACTIVE_ATTRIBUTES);for(let i=0;i<n;i++){const r=s.getActiveAttrib(e,i),a=r.name;let o=1;r.type===s.FLOAT_MAT2&&(o=2),r.type===s.FLOAT_MAT3&&(o=3),r.type===s.FLOAT_MAT4&&(o=4),t[a]={type:r.type,location:s.getAttribLocation(e,a),locationSize:o}}return t}function Ni(s){return s!==""}function Qa(s,e){const t=e.numSpotLightShadows+e.numSpotLightMaps-e.numSpotLightShadowsWithMaps;return s.replace(/NUM_SUN_LIGHTS/g,e.numSunLights).replace(/NUM_DIR_LIGHTS/g,e.numDirLights).replace(/NUM_SPOT_LIGHTS/g,e.numSpotLights).replace(/NUM_SPOT_LIGHT_MAPS/g,e.numSpotLightMaps).replace(/NUM_SPOT_LIGHT_COORDS/g,t).replace(/NUM_RECT_AREA_LIGHTS/g,e.numRectAreaLights).replace(/NUM_POINT_LIGHTS/g,e.numPointLights).replace(/NUM_HEMI_LIGHTS/g,e.numHemiLights).replace(/NUM_SUN_LIGHT_SHADOWS/g,e.numSunLightShadows).replace(/NUM_DIR_LIGHT_SHADOWS/g,e.numDirLightShadows).replace(/NUM_SPOT_LIGHT_SHADOWS_WITH_MAPS/g,e.numSpotLightShadowsWithMaps).replace(/NUM_SPOT_LIGHT_SHADOWS/g,e.numSpotLightShadows).replace(/NUM_POINT_LIGHT_SHADOWS/g,e.numPointLightShadows).replace(/NUM_LIGHT_PROBE_GRIDS/g,e.numLightProbeGrids)}function ja(s,e){return s.replace(/NUM_CLIPPING_PLANES/g,e.numClippingPlanes).replace(/UNION_CLIPPING_PLANES/g,e.numClippingPlanes-e.numClipIntersection)}const _f=/^[ \t]*#include +<([\w\d./]+)>/gm;function Fr(s){return s.replace(_f,vf)}function vf(s,e){const t=Ge[e];if(t===void 0)throw new Error("THREE.WebGLProgram: Can not resolve #include <"+e+">");return Fr(t)}const xf=/#pragma unroll_loop_start\s+for\s*\(\s*int\s+i\s*=\s*(\d+)\s*;\s*i\s*<\s*(\d+)\s*;\s*i\s*\+\+\s*\)\s*{([\s\S]+?)}\s+#pragma unroll_loop_end/g;function eo(s){return s.replace(xf,Sf)}function Sf(s,e,t,n){let i="";for(let r=parseInt(e);r<parseInt(t);r++)i+=n.replace(/\[\s*i\s*\]/g,"[ "+r+" ]").replace(/UNROLLED_LOOP_INDEX/g,r);return i}function to(s){let e=`precision ${s.precision} float;
	precision ${s.precision} int;
	precision ${s.precision} sampler2D;
	precision ${s.precision} samplerCube;
	precision ${s.precision} sampler3D;
	precision ${s.precision} sampler2DArray;
	precision ${s.precision} sampler2DShadow;
	precision ${s.precision} samplerCubeShadow;
	precision ${s.precision} sampler2DArrayShadow;
	precision ${s.precision} isampler2D;
	precision ${s.precision} isampler3D;
	precision ${s.precision} isamplerCube;
	precision ${s.precision} isampler2DArray;
	precision ${s.precision} usampler2D;
	precision ${s.precision} usampler3D;
	precision ${s.precision} usamplerCube;
	precision ${s.precision} usampler2DArray;
	`;return s.precision==="highp"?e+=`
#define HIGH_PRECISION`:s.precision==="mediump"?e+=`
#define MEDIUM_PRECISION`:s.precision==="lowp"&&(e+=`
#define LOW_PRECISION`),e}const Mf={1:"SHADOWMAP_TYPE_PCF",3:"SHADOWMAP_TYPE_VSM"};function wf(s){return Mf[s.shadowMapType]||"SHADOWMAP_TYPE_BASIC"}const yf={302:"ENVMAP_MODE_REFRACTION"};function bf(s){return s.envMap===!1?"ENVMAP_MODE_REFLECTION":yf[s.envMapMode]||"ENVMAP_MODE_REFLECTION"}const Ef={0:"ENVMAP_BLENDING_MULTIPLY",1:"ENVMAP_BLENDING_MIX",2:"ENVMAP_BLENDING_ADD"};function Tf(s){return s.envMap===!1?"ENVMAP_BLENDING_NONE":Ef[s.combine]||"ENVMAP_BLENDING_NONE"}function Af(s,e,t,n){const i=s.getContext(),r=t.defines;let a=t.vertexShader,o=t.fragmentShader;const l=wf(t),c=t.envMapPMREM===!0?"ENVMAP_TYPE_PMREM":"ENVMAP_TYPE_CUBE",h=bf(t),u=Tf(t),d=pf(t),f=mf(r),g=i.createProgram();let S,m,p=t.glslVersion?"#version "+t.glslVersion+`
`:"";t.isRawShaderMaterial?(S=["#define SHADER_TYPE "+t.shaderType,"#define SHADER_NAME "+t.shaderName,f].filter(Ni).join(`
`),S.length>0&&(S+=`
`),m=["#define SHADER_TYPE "+t.shaderType,"#define SHADER_NAME "+t.shaderName,f].filter(Ni).join(`
`),m.length>0&&(m+=`
`)):(S=[to(t),"#define SHADER_TYPE "+t.shaderType,"#define SHADER_NAME "+t.shaderName,f,t.extensionClipCullDistance?"#define USE_CLIP_DISTANCE":"",t.batching?"#define USE_BATCHING":"",t.batchingColor?"#define USE_BATCHING_COLOR":"",t.instancing?"#define USE_INSTANCING":"",t.instancingColor?"#define USE_INSTANCING_COLOR":"",t.instancingMorph?"#define USE_INSTANCING_MORPH":"",t.useFog&&t.fog?"#define USE_FOG":"",t.useFog&&t.fogExp2?"#define FOG_EXP2":"",t.map?"#define USE_MAP":"",t.envMap?"#define USE_ENVMAP":"",t.envMap?"#define "+h:"",t.lightMap?"#define USE_LIGHTMAP":"",t.aoMap?"#define USE_AOMAP":"",t.bumpMap?"#define USE_BUMPMAP":"",t.normalMap?"#define USE_NORMALMAP":"",t.normalMapObjectSpace?"#define USE_NORMALMAP_OBJECTSPACE":"",t.normalMapTangentSpace?"#define USE_NORMALMAP_TANGENTSPACE":"",t.displacementMap?"#define USE_DISPLACEMENTMAP":"",t.emissiveMap?"#define USE_EMISSIVEMAP":"",t.anisotropy?"#define USE_ANISOTROPY":"",t.anisotropyMap?"#define USE_ANISOTROPYMAP":"",t.clearcoatMap?"#define USE_CLEARCOATMAP":"",t.clearcoatRoughnessMap?"#define USE_CLEARCOAT_ROUGHNESSMAP":"",t.clearcoatNormalMap?"#define USE_CLEARCOAT_NORMALMAP":"",t.diffuseRoughnessMap?"#define USE_DIFFUSE_ROUGHNESSMAP":"",t.iridescenceMap?"#define USE_IRIDESCENCEMAP":"",t.iridescenceThicknessMap?"#define USE_IRIDESCENCE_THICKNESSMAP":"",t.specularMap?"#define USE_SPECULARMAP":"",t.specularColorMap?"#define USE_SPECULAR_COLORMAP":"",t.specularIntensityMap?"#define USE_SPECULAR_INTENSITYMAP":"",t.roughnessMap?"#define USE_ROUGHNESSMAP":"",t.metalnessMap?"#define USE_METALNESSMAP":"",t.alphaMap?"#define USE_ALPHAMAP":"",t.alphaHash?"#define USE_ALPHAHASH":"",t.transmission?"#define USE_TRANSMISSION":"",t.transmissionMap?"#define USE_TRANSMISSIONMAP":"",t.thicknessMap?"#define USE_THICKNESSMAP":"",t.sheenColorMap?"#define USE_SHEEN_COLORMAP":"",t.sheenRoughnessMap?"#define USE_SHEEN_ROUGHNESSMAP":"",t.mapUv?"#define MAP_UV "+t.mapUv:"",t.alphaMapUv?"#define ALPHAMAP_UV "+t.alphaMapUv:"",t.lightMapUv?"#define LIGHTMAP_UV "+t.lightMapUv:"",t.aoMapUv?"#define AOMAP_UV "+t.aoMapUv:"",t.emissiveMapUv?"#define EMISSIVEMAP_UV "+t.emissiveMapUv:"",t.bumpMapUv?"#define BUMPMAP_UV "+t.bumpMapUv:"",t.normalMapUv?"#define NORMALMAP_UV "+t.normalMapUv:"",t.displacementMapUv?"#define DISPLACEMENTMAP_UV "+t.displacementMapUv:"",t.metalnessMapUv?"#define METALNESSMAP_UV "+t.metalnessMapUv:"",t.roughnessMapUv?"#define ROUGHNESSMAP_UV "+t.roughnessMapUv:"",t.anisotropyMapUv?"#define ANISOTROPYMAP_UV "+t.anisotropyMapUv:"",t.clearcoatMapUv?"#define CLEARCOATMAP_UV "+t.clearcoatMapUv:"",t.clearcoatNormalMapUv?"#define CLEARCOAT_NORMALMAP_UV "+t.clearcoatNormalMapUv:"",t.clearcoatRoughnessMapUv?"#define CLEARCOAT_ROUGHNESSMAP_UV "+t.clearcoatRoughnessMapUv:"",t.diffuseRoughnessMapUv?"#define DIFFUSE_ROUGHNESSMAP_UV "+t.diffuseRoughnessMapUv:"",t.iridescenceMapUv?"#define IRIDESCENCEMAP_UV "+t.iridescenceMapUv:"",t.iridescenceThicknessMapUv?"#define IRIDESCENCE_THICKNESSMAP_UV "+t.iridescenceThicknessMapUv:"",t.sheenColorMapUv?"#define SHEEN_COLORMAP_UV "+t.sheenColorMapUv:"",t.sheenRoughnessMapUv?"#define SHEEN_ROUGHNESSMAP_UV "+t.sheenRoughnessMapUv:"",t.specularMapUv?"#define SPECULARMAP_UV "+t.specularMapUv:"",t.specularColorMapUv?"#define SPECULAR_COLORMAP_UV "+t.specularColorMapUv:"",t.specularIntensityMapUv?"#define SPECULAR_INTENSITYMAP_UV "+t.specularIntensityMapUv:"",t.transmissionMapUv?"#define TRANSMISSIONMAP_UV "+t.transmissionMapUv:"",t.thicknessMapUv?"#define THICKNESSMAP_UV "+t.thicknessMapUv:"",t.vertexTangents&&t.flatShading===!1?"#define USE_TANGENT":"",t.vertexNormals?"#define HAS_NORMAL":"",t.vertexColors?"#define USE_COLOR":"",t.vertexAlphas?"#define USE_COLOR_ALPHA":"",t.vertexUv1s?"#define USE_UV1":"",t.vertexUv2s?"#define USE_UV2":"",t.vertexUv3s?"#define USE_UV3":"",t.pointsUvs?"#define USE_POINTS_UV":"",t.flatShading?"#define FLAT_SHADED":"",t.skinning?"#define USE_SKINNING":"",t.morphTargets?"#define USE_MORPHTARGETS":"",t.morphNormals&&t.flatShading===!1?"#define USE_MORPHNORMALS":"",t.morphColors?"#define USE_MORPHCOLORS":"",t.morphTargetsCount>0?"#define MORPHTARGETS_TEXTURE_STRIDE "+t.morphTextureStride:"",t.morphTargetsCount>0?"#define MORPHTARGETS_COUNT "+t.morphTargetsCount:"",t.doubleSided?"#define DOUBLE_SIDED":"",t.flipSided?"#define FLIP_SIDED":"",t.shadowMapEnabled?"#define USE_SHADOWMAP":"",t.shadowMapEnabled?"#define "+l:"",t.sizeAttenuation?"#define USE_SIZEATTENUATION":"",t.numLightProbes>0?"#define USE_LIGHT_PROBES":"",t.logarithmicDepthBuffer?"#define USE_LOGARITHMIC_DEPTH_BUFFER":"",t.reversedDepthBuffer?"#define USE_REVERSED_DEPTH_BUFFER":"","uniform mat4 modelMatrix;","uniform mat4 modelViewMatrix;","uniform mat4 projectionMatrix;","uniform mat4 viewMatrix;","uniform mat3 normalMatrix;","uniform vec3 cameraPosition;","uniform bool isOrthographic;","#ifdef USE_INSTANCING","	attribute mat4 instanceMatrix;","#endif","#ifdef USE_INSTANCING_COLOR","	attribute vec3 instanceColor;","#endif","#ifdef USE_INSTANCING_MORPH","	uniform sampler2D morphTexture;","#endif","attribute vec3 position;","attribute vec3 normal;","attribute vec2 uv;","#ifdef USE_UV1","	attribute vec2 uv1;","#endif","#ifdef USE_UV2","	attribute vec2 uv2;","#endif","#ifdef USE_UV3","	attribute vec2 uv3;","#endif","#ifdef USE_TANGENT","	attribute vec4 tangent;","#endif","#if defined( USE_COLOR_ALPHA )","	attribute vec4 color;","#elif defined( USE_COLOR )","	attribute vec3 color;","#endif","#ifdef USE_SKINNING","	attribute vec4 skinIndex;","	attribute vec4 skinWeight;","#endif",`
`].filter(Ni).join(`
`),m=[to(t),"#define SHADER_TYPE "+t.shaderType,"#define SHADER_NAME "+t.shaderName,f,t.useFog&&t.fog?"#define USE_FOG":"",t.useFog&&t.fogExp2?"#define FOG_EXP2":"",t.alphaToCoverage?"#define ALPHA_TO_COVERAGE":"",t.map?"#define USE_MAP":"",t.matcap?"#define USE_MATCAP":"",t.envMap?"#define USE_ENVMAP":"",t.envMap?"#define "+c:"",t.envMap?"#define "+h:"",t.envMap?"#define "+u:"",t.envMapPMREM?"#define ENVMAP_MAX_LOD "+t.envMapMaxLod+".0":"",t.envMapPMREM?"#define ENVMAP_SIZE "+t.envMapSize+".0":"",t.lightMap?"#define USE_LIGHTMAP":"",t.aoMap?"#define USE_AOMAP":"",t.bumpMap?"#define USE_BUMPMAP":"",t.normalMap?"#define USE_NORMALMAP":"",t.normalMapObjectSpace?"#define USE_NORMALMAP_OBJECTSPACE":"",t.normalMapTangentSpace?"#define USE_NORMALMAP_TANGENTSPACE":"",t.packedNormalMap?"#define USE_PACKED_NORMALMAP":"",t.emissiveMap?"#define USE_EMISSIVEMAP":"",t.anisotropy?"#define USE_ANISOTROPY":"",t.anisotropyMap?"#define USE_ANISOTROPYMAP":"",t.clearcoat?"#define USE_CLEARCOAT":"",t.clearcoatMap?"#define USE_CLEARCOATMAP":"",t.clearcoatRoughnessMap?"#define USE_CLEARCOAT_ROUGHNESSMAP":"",t.clearcoatNormalMap?"#define USE_CLEARCOAT_NORMALMAP":"",t.diffuseRoughness?"#define USE_DIFFUSE_ROUGHNESS":"",t.diffuseRoughnessMap?"#define USE_DIFFUSE_ROUGHNESSMAP":"",t.dispersion?"#define USE_DISPERSION":"",t.retroreflection?"#define USE_RETROREFLECTION":"",t.iridescence?"#define USE_IRIDESCENCE":"",t.iridescenceMap?"#define USE_IRIDESCENCEMAP":"",t.iridescenceThicknessMap?"#define USE_IRIDESCENCE_THICKNESSMAP":"",t.specularMap?"#define USE_SPECULARMAP":"",t.specularColorMap?"#define USE_SPECULAR_COLORMAP":"",t.specularIntensityMap?"#define USE_SPECULAR_INTENSITYMAP":"",t.roughnessMap?"#define USE_ROUGHNESSMAP":"",t.metalnessMap?"#define USE_METALNESSMAP":"",t.alphaMap?"#define USE_ALPHAMAP":"",t.alphaTest?"#define USE_ALPHATEST":"",t.alphaHash?"#define USE_ALPHAHASH":"",t.sheen?"#define USE_SHEEN":"",t.sheenColorMap?"#define USE_SHEEN_COLORMAP":"",t.sheenRoughnessMap?"#define USE_SHEEN_ROUGHNESSMAP":"",t.transmission?"#define USE_TRANSMISSION":"",t.transmissionMap?"#define USE_TRANSMISSIONMAP":"",t.thicknessMap?"#define USE_THICKNESSMAP":"",t.vertexTangents&&t.flatShading===!1?"#define USE_TANGENT":"",t.vertexColors||t.instancingColor?"#define USE_COLOR":"",t.vertexAlphas||t.batchingColor?"#define USE_COLOR_ALPHA":"",t.vertexUv1s?"#define USE_UV1":"",t.vertexUv2s?"#define USE_UV2":"",t.vertexUv3s?"#define USE_UV3":"",t.pointsUvs?"#define USE_POINTS_UV":"",t.gradientMap?"#define USE_GRADIENTMAP":"",t.flatShading?"#define FLAT_SHADED":"",t.doubleSided?"#define DOUBLE_SIDED":"",t.flipSided?"#define FLIP_SIDED":"",t.shadowMapEnabled?"#define USE_SHADOWMAP":"",t.shadowMapEnabled?"#define "+l:"",t.premultipliedAlpha?"#define PREMULTIPLIED_ALPHA":"",t.numLightProbes>0?"#define USE_LIGHT_PROBES":"",t.decodeVideoTexture?"#define DECODE_VIDEO_TEXTURE":"",t.decodeVideoTextureEmissive?"#define DECODE_VIDEO_TEXTURE_EMISSIVE":"",t.logarithmicDepthBuffer?"#define USE_LOGARITHMIC_DEPTH_BUFFER":"",t.reversedDepthBuffer?"#define USE_REVERSED_DEPTH_BUFFER":"","uniform mat4 viewMatrix;","uniform vec3 cameraPosition;","uniform bool isOrthographic;",t.toneMapping!==0?"#define TONE_MAPPING":"",t.toneMapping!==0?Ge.tonemapping_pars_fragment:"",t.toneMapping!==0?uf("toneMapping",t.toneMapping):"",t.dithering?"#define DITHERING":"",t.opaque?"#define OPAQUE":"",Ge.colorspace_pars_fragment,hf("linearToOutputTexel",t.outputColorSpace),ff(),t.useDepthPacking?"#define DEPTH_PACKING "+t.depthPacking:"",`
`].filter(Ni).join(`
`)),a=Fr(a),a=Qa(a,t),a=ja(a,t),o=Fr(o),o=Qa(o,t),o=ja(o,t),a=eo(a),o=eo(o),t.isRawShaderMaterial!==!0&&(p=`#version 300 es
`,S=[d,"#define attribute in","#define varying out","#define texture2D texture"].join(`
`)+`
`+S,m=["#define varying in",t.glslVersion===ca?"":"layout(location = 0) out highp vec4 pc_fragColor;",t.glslVersion===ca?"":"#define gl_FragColor pc_fragColor","#define gl_FragDepthEXT gl_FragDepth","#define texture2D texture","#define textureCube texture","#define texture2DProj textureProj","#define texture2DLodEXT textureLod","#define texture2DProjLodEXT textureProjLod","#define textureCubeLodEXT textureLod","#define texture2DGradEXT textureGrad","#define texture2DProjGradEXT textureProjGrad","#define textureCubeGradEXT textureGrad"].join(`
`)+`
`+m);const M=p+S+a,A=p+m+o,b=Ka(i,i.VERTEX_SHADER,M),R=Ka(i,i.FRAGMENT_SHADER,A);i.attachShader(g,b),i.attachShader(g,R),t.index0AttributeName!==void 0?i.bindAttribLocation(g,0,t.index0AttributeName):t.hasPositionAttribute===!0&&i.bindAttribLocation(g,0,"position"),i.linkProgram(g);function E(N){if(s.debug.checkShaderErrors){const I=i.getProgramInfoLog(g)||"",z=i.getShaderInfoLog(b)||"",$=i.getShaderInfoLog(R)||"",P=I.trim(),W=z.trim(),Z=$.trim();let H=!0,te=!0;if(i.getProgramParameter(g,i.LINK_STATUS)===!1)if(H=!1,typeof s.debug.onShaderError=="function")s.debug.onShaderError(i,g,b,R);else{const V=Ja(i,b,"vertex"),j=Ja(i,R,"fragment");Je("WebGLProgram: Shader Error "+i.getError()+" - VALIDATE_STATUS "+i.getProgramParameter(g,i.VALIDATE_STATUS)+`

Material Name: `+N.name+`
Material Type: `+N.type+`

Program Info Log: `+P+`
`+V+`
`+j)}else P!==""?Le("WebGLProgram: Program Info Log:",P):(W===""||Z==="")&&(te=!1);te&&(N.diagnostics={runnable:H,programLog:P,vertexShader:{log:W,prefix:S},fragmentShader:{log:Z,prefix:m}})}i.deleteShader(b),i.deleteShader(R),_=new As(i,g),y=gf(i,g)}let _;this.getUniforms=function(){return _===void 0&&E(this),_};let y;this.getAttributes=function(){return y===void 0&&E(this),y};let k=t.rendererExtensionParallelShaderCompile===!1;return this.isReady=function(){return k===!1&&(k=i.getProgramParameter(g,af)),k},this.destroy=function(){n.releaseStatesOfProgram(this),i.deleteProgram(g),this.program=void 0},this.type=t.shaderType,this.name=t.shaderName,this.id=of++,this.cacheKey=e,this.usedTimes=1,this.program=g,this.vertexShader=b,this.fragmentShader=R,this}let Rf=0;class Cf{constructor(){this.shaderCache=new Map,this.materialCache=new Map}update(e,t,n){const i=this._getShaderCacheForMaterial(e);return i.has(t)===!1&&(i.add(t),t.usedTimes++),i.has(n)===!1&&(i.add(n),n.usedTimes++),this}remove(e){const t=this.materialCache.get(e);for(const n of t)n.usedTimes--,n.usedTimes===0&&this.shaderCache.delete(n.code);return this.materialCache.delete(e),this}getVertexShaderStage(e){return this._getShaderStage(e.vertexShader)}getFragmentShaderStage(e){return this._getShaderStage(e.fragmentShader)}dispose(){this.shaderCache.clear(),this.materialCache.clear()}_getShaderCacheForMaterial(e){const t=this.materialCache;let n=t.get(e);return n===void 0&&(n=new Set,t.set(e,n)),n}_getShaderStage(e){const t=this.shaderCache;let n=t.get(e);return n===void 0&&(n=new Pf(e),t.set(e,n)),n}}class Pf{constructor(e){this.id=Rf++,this.code=e,this.usedTimes=0}}function Lf(s){return s===1030||s===37490||s===36285}function Df(s,e,t,n,i,r){const a=new Hr,o=new Cf,l=new Set,c=[],h=new Map,u=n.logarithmicDepthBuffer,d={MeshDepthMaterial:"depth",MeshDistanceMaterial:"distance",MeshNormalMaterial:"normal",MeshBasicMaterial:"basic",MeshLambertMaterial:"lambert",MeshPhongMaterial:"phong",MeshToonMaterial:"toon",MeshStandardMaterial:"physical",MeshPhysicalMaterial:"physical",MeshMatcapMaterial:"matcap",LineBasicMaterial:"basic",LineDashedMaterial:"dashed",PointsMaterial:"points",ShadowMaterial:"shadow",SpriteMaterial:"sprite"};function f(_){return l.add(_),_===0?"uv":`uv${_}`}function g(_,y,k,N,I,z){const $=N.fog,P=I.geometry,W=_.isMeshStandardMaterial||_.isMeshLambertMaterial||_.isMeshPhongMaterial?N.environment:null,Z=_.isMeshStandardMaterial||_.isMeshLambertMaterial&&!_.envMap||_.isMeshPhongMaterial&&!_.envMap,H=e.get(_.envMap||W,Z),te=d[_.type];let V=n.precision;_.precision!==null&&(V=n.getMaxPrecision(_.precision),V!==_.precision&&Le("WebGLProgram.getParameters:",_.precision,"not supported, using",V,"instead."));const j=P.morphAttributes.position||P.morphAttributes.normal||P.morphAttributes.color,ee=j!==void 0?j.length:0;let we=0;P.morphAttributes.position!==void 0&&(we=1),P.morphAttributes.normal!==void 0&&(we=2),P.morphAttributes.color!==void 0&&(we=3);let Pe,q,he,ve;if(te){const me=hn[te];Pe=me.vertexShader,q=me.fragmentShader}else{Pe=_.vertexShader,q=_.fragmentShader;const me=o.getVertexShaderStage(_),et=o.getFragmentShaderStage(_);o.update(_,me,et),he=me.id,ve=et.id}const Ee=s.getRenderTarget(),fe=s.state.buffers.depth.getReversed(),De=I.isInstancedMesh===!0,Ke=I.isBatchedMesh===!0,Te=!!_.map,He=!!_.matcap,Ne=!!H,Be=Ne&&H.isPMREMTexture===!0,dt=!!_.aoMap,at=!!_.lightMap,Ut=!!_.bumpMap&&_.wireframe===!1,ot=!!_.normalMap,an=!!_.displacementMap,Mt=!!_.emissiveMap,Ht=!!_.metalnessMap,Vt=!!_.roughnessMap,Wt=_.anisotropy>0,F=_.clearcoat>0,Xt=_.diffuseRoughness>0,st=_.dispersion>0,rt=_.retroreflectivity>0,pe=_.iridescence>0,_t=_.sheen>0,Ce=_.transmission>0,Fe=Wt&&!!_.anisotropyMap,w=F&&!!_.clearcoatMap,v=F&&!!_.clearcoatNormalMap,O=F&&!!_.clearcoatRoughnessMap,ne=Xt&&!!_.diffuseRoughnessMap,Q=pe&&!!_.iridescenceMap,re=pe&&!!_.iridescenceThicknessMap,de=_t&&!!_.sheenColorMap,Y=_t&&!!_.sheenRoughnessMap,K=!!_.specularMap,oe=!!_.specularColorMap,T=!!_.specularIntensityMap,J=Ce&&!!_.transmissionMap,X=Ce&&!!_.thicknessMap,le=!!_.gradientMap,se=!!_.alphaMap,ae=_.alphaTest>0,be=!!_.alphaHash,ke=!!_.extensions;let ie=0;_.toneMapped&&(Ee===null||Ee.isXRRenderTarget===!0)&&(ie=s.toneMapping);const Re=Be?H.isCompressedCubeTexture?H.image[0].mipmaps:H.mipmaps:null,Oe={shaderID:te,shaderType:_.type,shaderName:_.name,vertexShader:Pe,fragmentShader:q,defines:_.defines,customVertexShaderID:he,customFragmentShaderID:ve,isRawShaderMaterial:_.isRawShaderMaterial===!0,glslVersion:_.glslVersion,precision:V,batching:Ke,batchingColor:Ke&&I._colorsTexture!==null,instancing:De,instancingColor:De&&I.instanceColor!==null,instancingMorph:De&&I.morphTexture!==null,outputColorSpace:Ee===null?s.outputColorSpace:Ee.isXRRenderTarget===!0?Ee.texture.colorSpace:qe.workingColorSpace,alphaToCoverage:!!_.alphaToCoverage,map:Te,matcap:He,envMap:Ne,envMapMode:Ne&&H.mapping,envMapPMREM:Be,envMapMaxLod:Be?Re.length-1:null,envMapSize:Be?Re[0].width:null,aoMap:dt,lightMap:at,bumpMap:Ut,normalMap:ot,displacementMap:an,emissiveMap:Mt,normalMapObjectSpace:ot&&_.normalMapType===1,normalMapTangentSpace:ot&&_.normalMapType===0,packedNormalMap:ot&&_.normalMapType===0&&Lf(_.normalMap.format),metalnessMap:Ht,roughnessMap:Vt,anisotropy:Wt,anisotropyMap:Fe,clearcoat:F,clearcoatMap:w,clearcoatNormalMap:v,clearcoatRoughnessMap:O,diffuseRoughness:Xt,diffuseRoughnessMap:ne,dispersion:st,retroreflection:rt,iridescence:pe,iridescenceMap:Q,iridescenceThicknessMap:re,sheen:_t,sheenColorMap:de,sheenRoughnessMap:Y,specularMap:K,specularColorMap:oe,specularIntensityMap:T,transmission:Ce,transmissionMap:J,thicknessMap:X,gradientMap:le,opaque:_.transparent===!1&&_.blending===1&&_.alphaToCoverage===!1,alphaMap:se,alphaTest:ae,alphaHash:be,combine:_.combine,mapUv:Te&&f(_.map.channel),aoMapUv:dt&&f(_.aoMap.channel),lightMapUv:at&&f(_.lightMap.channel),bumpMapUv:Ut&&f(_.bumpMap.channel),normalMapUv:ot&&f(_.normalMap.channel),displacementMapUv:an&&f(_.displacementMap.channel),emissiveMapUv:Mt&&f(_.emissiveMap.channel),metalnessMapUv:Ht&&f(_.metalnessMap.channel),roughnessMapUv:Vt&&f(_.roughnessMap.channel),anisotropyMapUv:Fe&&f(_.anisotropyMap.channel),clearcoatMapUv:w&&f(_.clearcoatMap.channel),clearcoatNormalMapUv:v&&f(_.clearcoatNormalMap.channel),clearcoatRoughnessMapUv:O&&f(_.clearcoatRoughnessMap.channel),diffuseRoughnessMapUv:ne&&f(_.diffuseRoughnessMap.channel),iridescenceMapUv:Q&&f(_.iridescenceMap.channel),iridescenceThicknessMapUv:re&&f(_.iridescenceThicknessMap.channel),sheenColorMapUv:de&&f(_.sheenColorMap.channel),sheenRoughnessMapUv:Y&&f(_.sheenRoughnessMap.channel),specularMapUv:K&&f(_.specularMap.channel),specularColorMapUv:oe&&f(_.specularColorMap.channel),specularIntensityMapUv:T&&f(_.specularIntensityMap.channel),transmissionMapUv:J&&f(_.transmissionMap.channel),thicknessMapUv:X&&f(_.thicknessMap.channel),alphaMapUv:se&&f(_.alphaMap.channel),vertexTangents:!!P.attributes.tangent&&(ot||Wt),vertexNormals:!!P.attributes.normal,vertexColors:_.vertexColors,vertexAlphas:_.vertexColors===!0&&!!P.attributes.color&&P.attributes.color.itemSize===4,pointsUvs:I.isPoints===!0&&!!P.attributes.uv&&(Te||se),fog:!!$,useFog:_.fog===!0,fogExp2:!!$&&$.isFogExp2,flatShading:_.wireframe===!1&&(_.flatShading===!0||P.attributes.normal===void 0&&ot===!1&&(_.isMeshLambertMaterial||_.isMeshPhongMaterial||_.isMeshStandardMaterial||_.isMeshPhysicalMaterial)),sizeAttenuation:_.sizeAttenuation===!0,logarithmicDepthBuffer:u,reversedDepthBuffer:fe,skinning:I.isSkinnedMesh===!0,hasPositionAttribute:P.attributes.position!==void 0,morphTargets:P.morphAttributes.position!==void 0,morphNormals:P.morphAttributes.normal!==void 0,morphColors:P.morphAttributes.color!==void 0,morphTargetsCount:ee,morphTextureStride:we,numSunLights:y.sun.length,numDirLights:y.directional.length,numPointLights:y.point.length,numSpotLights:y.spot.length,numSpotLightMaps:y.spotLightMap.length,numRectAreaLights:y.rectArea.length,numHemiLights:y.hemi.length,numSunLightShadows:y.sunShadowMap.length,numDirLightShadows:y.directionalShadowMap.length,numPointLightShadows:y.pointShadowMap.length,numSpotLightShadows:y.spotShadowMap.length,numSpotLightShadowsWithMaps:y.numSpotLightShadowsWithMaps,numLightProbes:y.numLightProbes,numLightProbeGrids:z.filter(me=>me.texture!==null).length,numClippingPlanes:r.numPlanes,numClipIntersection:r.numIntersection,dithering:_.dithering,shadowMapEnabled:s.shadowMap.enabled&&k.length>0,shadowMapType:s.shadowMap.type,toneMapping:ie,decodeVideoTexture:Te&&_.map.isVideoTexture===!0&&qe.getTransfer(_.map.colorSpace)===tt,decodeVideoTextureEmissive:Mt&&_.emissiveMap.isVideoTexture===!0&&qe.getTransfer(_.emissiveMap.colorSpace)===tt,premultipliedAlpha:_.premultipliedAlpha,doubleSided:_.side===2,flipSided:_.side===1,useDepthPacking:_.depthPacking>=0,depthPacking:_.depthPacking||0,index0AttributeName:_.index0AttributeName,extensionClipCullDistance:ke&&_.extensions.clipCullDistance===!0&&t.has("WEBGL_clip_cull_distance"),extensionMultiDraw:(ke&&_.extensions.multiDraw===!0||Ke)&&t.has("WEBGL_multi_draw"),rendererExtensionParallelShaderCompile:t.has("KHR_parallel_shader_compile"),customProgramCacheKey:_.customProgramCacheKey()};return Oe.vertexUv1s=l.has(1),Oe.vertexUv2s=l.has(2),Oe.vertexUv3s=l.has(3),l.clear(),Oe}function S(_){const y=[];if(_.shaderID?y.push(_.shaderID):(y.push(_.customVertexShaderID),y.push(_.customFragmentShaderID)),_.defines!==void 0)for(const k in _.defines)y.push(k),y.push(_.defines[k]);return _.isRawShaderMaterial===!1&&(m(y,_),p(y,_),y.push(s.outputColorSpace)),y.push(_.customProgramCacheKey),y.join()}function m(_,y){_.push(y.precision),_.push(y.outputColorSpace),_.push(y.envMapMode),_.push(y.envMapPMREM),_.push(y.envMapMaxLod),_.push(y.envMapSize),_.push(y.mapUv),_.push(y.alphaMapUv),_.push(y.lightMapUv),_.push(y.aoMapUv),_.push(y.bumpMapUv),_.push(y.normalMapUv),_.push(y.displacementMapUv),_.push(y.emissiveMapUv),_.push(y.metalnessMapUv),_.push(y.roughnessMapUv),_.push(y.anisotropyMapUv),_.push(y.clearcoatMapUv),_.push(y.clearcoatNormalMapUv),_.push(y.clearcoatRoughnessMapUv),_.push(y.diffuseRoughnessMapUv),_.push(y.iridescenceMapUv),_.push(y.iridescenceThicknessMapUv),_.push(y.sheenColorMapUv),_.push(y.sheenRoughnessMapUv),_.push(y.specularMapUv),_.push(y.specularColorMapUv),_.push(y.specularIntensityMapUv),_.push(y.transmissionMapUv),_.push(y.thicknessMapUv),_.push(y.combine),_.push(y.fogExp2),_.push(y.sizeAttenuation),_.push(y.morphTargetsCount),_.push(y.numSunLights),_.push(y.numDirLights),_.push(y.numPointLights),_.push(y.numSpotLights),_.push(y.numSpotLightMaps),_.push(y.numHemiLights),_.push(y.numRectAreaLights),_.push(y.numSunLightShadows),_.push(y.numDirLightShadows),_.push(y.numPointLightShadows),_.push(y.numSpotLightShadows),_.push(y.numSpotLightShadowsWithMaps),_.push(y.numLightProbes),_.push(y.numLightProbeGrids),_.push(y.shadowMapType),_.push(y.toneMapping),_.push(y.numClippingPlanes),_.push(y.numClipIntersection),_.push(y.depthPacking)}function p(_,y){a.disableAll(),y.instancing&&a.enable(0),y.instancingColor&&a.enable(1),y.instancingMorph&&a.enable(2),y.matcap&&a.enable(3),y.envMap&&a.enable(4),y.normalMapObjectSpace&&a.enable(5),y.normalMapTangentSpace&&a.enable(6),y.clearcoat&&a.enable(7),y.iridescence&&a.enable(8),y.alphaTest&&a.enable(9),y.vertexColors&&a.enable(10),y.vertexAlphas&&a.enable(11),y.vertexUv1s&&a.enable(12),y.vertexUv2s&&a.enable(13),y.vertexUv3s&&a.enable(14),y.vertexTangents&&a.enable(15),y.anisotropy&&a.enable(16),y.alphaHash&&a.enable(17),y.batching&&a.enable(18),y.dispersion&&a.enable(19),y.retroreflection&&a.enable(24),y.diffuseRoughness&&a.enable(25),y.batchingColor&&a.enable(20),y.gradientMap&&a.enable(21),y.packedNormalMap&&a.enable(22),y.vertexNormals&&a.enable(23),_.push(a.mask),a.disableAll(),y.fog&&a.enable(0),y.useFog&&a.enable(1),y.flatShading&&a.enable(2),y.logarithmicDepthBuffer&&a.enable(3),y.reversedDepthBuffer&&a.enable(4),y.skinning&&a.enable(5),y.morphTargets&&a.enable(6),y.morphNormals&&a.enable(7),y.morphColors&&a.enable(8),y.premultipliedAlpha&&a.enable(9),y.shadowMapEnabled&&a.enable(10),y.doubleSided&&a.enable(11),y.flipSided&&a.enable(12),y.useDepthPacking&&a.enable(13),y.dithering&&a.enable(14),y.transmission&&a.enable(15),y.sheen&&a.enable(16),y.opaque&&a.enable(17),y.pointsUvs&&a.enable(18),y.decodeVideoTexture&&a.enable(19),y.decodeVideoTextureEmissive&&a.enable(20),y.alphaToCoverage&&a.enable(21),y.numLightProbeGrids>0&&a.enable(22),y.hasPositionAttribute&&a.enable(23),_.push(a.mask)}function M(_){const y=d[_.type];let k;if(y){const N=hn[y];k=nc.clone(N.uniforms)}else k=_.uniforms;return k}function A(_,y){let k=h.get(y);return k!==void 0?++k.usedTimes:(k=new Af(s,y,_,i),c.push(k),h.set(y,k)),k}function b(_){if(--_.usedTimes===0){const y=c.indexOf(_);c[y]=c[c.length-1],c.pop(),h.delete(_.cacheKey),_.destroy()}}function R(_){o.remove(_)}function E(){o.dispose()}return{getParameters:g,getProgramCacheKey:S,getUniforms:M,acquireProgram:A,releaseProgram:b,releaseShaderCache:R,programs:c,dispose:E}}function Nf(){let s=new WeakMap;function e(a){return s.has(a)}function t(a){let o=s.get(a);return o===void 0&&(o={},s.set(a,o)),o}function n(a){s.delete(a)}function i(a,o,l){s.get(a)[o]=l}function r(){s=new WeakMap}return{has:e,get:t,remove:n,update:i,dispose:r}}function Ff(s,e){return s.groupOrder!==e.groupOrder?s.groupOrder-e.groupOrder:s.renderOrder!==e.renderOrder?s.renderOrder-e.renderOrder:s.material.id!==e.material.id?s.material.id-e.material.id:s.materialVariant!==e.materialVariant?s.materialVariant-e.materialVariant:s.z!==e.z?s.z-e.z:s.id-e.id}function no(s,e){return s.groupOrder!==e.groupOrder?s.groupOrder-e.groupOrder:s.renderOrder!==e.renderOrder?s.renderOrder-e.renderOrder:s.z!==e.z?e.z-s.z:s.id-e.id}function io(){const s=[];let e=0;const t=[],n=[],i=[];function r(){e=0,t.length=0,n.length=0,i.length=0}function a(d){let f=0;return d.isInstancedMesh&&(f+=2),d.isSkinnedMesh&&(f+=1),f}function o(d,f,g,S,m,p){let M=s[e];return M===void 0?(M={id:d.id,object:d,geometry:f,material:g,materialVariant:a(d),groupOrder:S,renderOrder:d.renderOrder,z:m,group:p},s[e]=M):(M.id=d.id,M.object=d,M.geometry=f,M.material=g,M.materialVariant=a(d),M.groupOrder=S,M.renderOrder=d.renderOrder,M.z=m,M.group=p),e++,M}function l(d,f,g,S,m,p,M){M.reversedDepth===!0&&(m=-m);const A=o(d,f,g,S,m,p);g.transmission>0?n.push(A):g.transparent===!0?i.push(A):t.push(A)}function c(d,f,g,S,m,p){const M=o(d,f,g,S,m,p);g.transmission>0?n.unshift(M):g.transparent===!0?i.unshift(M):t.unshift(M)}function h(d,f){t.length>1&&t.sort(d||Ff),n.length>1&&n.sort(f||no),i.length>1&&i.sort(f||no)}function u(){for(let d=e,f=s.length;d<f;d++){const g=s[d];if(g.id===null)break;g.id=null,g.object=null,g.geometry=null,g.material=null,g.group=null}}return{opaque:t,transmissive:n,transparent:i,init:r,push:l,unshift:c,finish:u,sort:h}}function If(){let s=new WeakMap;function e(n,i){const r=s.get(n);let a;return r===void 0?(a=new io,s.set(n,[a])):i>=r.length?(a=new io,r.push(a)):a=r[i],a}function t(){s=new WeakMap}return{get:e,dispose:t}}function Uf(){const s={};return{get:function(e){if(s[e.id]!==void 0)return s[e.id];let t;switch(e.type){case"SunLight":case"DirectionalLight":t={direction:new D,color:new Xe};break;case"SpotLight":t={position:new D,direction:new D,color:new Xe,distance:0,coneCos:0,penumbraCos:0,decay:0};break;case"PointLight":t={position:new D,color:new Xe,distance:0,decay:0};break;case"HemisphereLight":t={direction:new D,skyColor:new Xe,groundColor:new Xe};break;case"RectAreaLight":t={color:new Xe,position:new D,halfWidth:new D,halfHeight:new D};break}return s[e.id]=t,t}}}function Of(){const s={};return{get:function(e){if(s[e.id]!==void 0)return s[e.id];let t;switch(e.type){case"SunLight":case"DirectionalLight":t={shadowIntensity:1,shadowBias:0,shadowNormalBias:0,shadowRadius:1,shadowMapSize:new Ye};break;case"SpotLight":t={shadowIntensity:1,shadowBias:0,shadowNormalBias:0,shadowRadius:1,shadowMapSize:new Ye};break;case"PointLight":t={shadowIntensity:1,shadowBias:0,shadowNormalBias:0,shadowRadius:1,shadowMapSize:new Ye,shadowCameraNear:1,shadowCameraFar:1e3};break}return s[e.id]=t,t}}}let Bf=0;function kf(s,e){return(e.castShadow?2:0)-(s.castShadow?2:0)+(e.map?1:0)-(s.map?1:0)}function Gf(s){const e=new Uf,t=Of(),n={version:0,hash:{sunLength:-1,directionalLength:-1,pointLength:-1,spotLength:-1,rectAreaLength:-1,hemiLength:-1,numSunShadows:-1,numDirectionalShadows:-1,numPointShadows:-1,numSpotShadows:-1,numSpotMaps:-1,numLightProbes:-1},ambient:[0,0,0],probe:[],sun:[],sunShadow:[],sunShadowMap:[],sunShadowMatrix:[],sunShadowCascade:[],directional:[],directionalShadow:[],directionalShadowMap:[],directionalShadowMatrix:[],spot:[],spotLightMap:[],spotShadow:[],spotShadowMap:[],spotLightMatrix:[],rectArea:[],rectAreaLTC1:null,rectAreaLTC2:null,point:[],pointShadow:[],pointShadowMap:[],pointShadowMatrix:[],hemi:[],numSpotLightShadowsWithMaps:0,numLightProbes:0};for(let c=0;c<9;c++)n.probe.push(new D);const i=new D,r=new Qe,a=new Qe;function o(c){let h=0,u=0,d=0;for(let z=0;z<9;z++)n.probe[z].set(0,0,0);let f=0,g=0,S=0,m=0,p=0,M=0,A=0,b=0,R=0,E=0,_=0,y=0,k=0,N=0;c.sort(kf);for(let z=0,$=c.length;z<$;z++){const P=c[z],W=P.color,Z=P.intensity,H=P.distance;let te=null;if(P.shadow&&P.shadow.map&&(P.shadow.map.texture.format===1030?te=P.shadow.map.texture:te=P.shadow.map.depthTexture||P.shadow.map.texture),P.isAmbientLight)h+=W.r*Z,u+=W.g*Z,d+=W.b*Z;else if(P.isLightProbe){for(let V=0;V<9;V++)n.probe[V].addScaledVector(P.sh.coefficients[V],Z);N++}else if(P.isSunLight){const V=e.get(P);if(V.color.copy(P.color).multiplyScalar(P.intensity),P.castShadow){const j=P.shadow,ee=t.get(P);ee.shadowIntensity=j.intensity,ee.shadowBias=j.bias,ee.shadowNormalBias=j.normalBias,ee.shadowRadius=j.radius,ee.shadowMapSize.copy(j.mapSize).multiply(j.getFrameExtents()),n.sunShadow[g]=ee,n.sunShadowMap[g]=te;const we=j.getViewportCount();for(let Pe=0;Pe<we;Pe++)n.sunShadowMatrix[S+Pe]=j.getMatrix(Pe),n.sunShadowCascade[S+Pe]=j._cascadeData[Pe];S+=we,g++}n.sun[f]=V,f++}else if(P.isDirectionalLight){const V=e.get(P);if(V.color.copy(P.color).multiplyScalar(P.intensity),P.castShadow){const j=P.shadow,ee=t.get(P);ee.shadowIntensity=j.intensity,ee.shadowBias=j.bias,ee.shadowNormalBias=j.normalBias,ee.shadowRadius=j.radius,ee.shadowMapSize=j.mapSize,n.directionalShadow[m]=ee,n.directionalShadowMap[m]=te,n.directionalShadowMatrix[m]=P.shadow.matrix,R++}n.directional[m]=V,m++}else if(P.isSpotLight){const V=e.get(P);V.position.setFromMatrixPosition(P.matrixWorld),V.color.copy(W).multiplyScalar(Z),V.distance=H,V.coneCos=Math.cos(P.angle),V.penumbraCos=Math.cos(P.angle*(1-P.penumbra)),V.decay=P.decay,n.spot[M]=V;const j=P.shadow;if(P.map&&(n.spotLightMap[y]=P.map,y++,j.updateMatrices(P),P.castShadow&&k++),n.spotLightMatrix[M]=j.matrix,P.castShadow){const ee=t.get(P);ee.shadowIntensity=j.intensity,ee.shadowBias=j.bias,ee.shadowNormalBias=j.normalBias,ee.shadowRadius=j.radius,ee.shadowMapSize=j.mapSize,n.spotShadow[M]=ee,n.spotShadowMap[M]=te,_++}M++}else if(P.isRectAreaLight){const V=e.get(P);V.color.copy(W).multiplyScalar(Z),V.halfWidth.set(P.width*.5,0,0),V.halfHeight.set(0,P.height*.5,0),n.rectArea[A]=V,A++}else if(P.isPointLight){const V=e.get(P);if(V.color.copy(P.color).multiplyScalar(P.intensity),V.distance=P.distance,V.decay=P.decay,P.castShadow){const j=P.shadow,ee=t.get(P);ee.shadowIntensity=j.intensity,ee.shadowBias=j.bias,ee.shadowNormalBias=j.normalBias,ee.shadowRadius=j.radius,ee.shadowMapSize=j.mapSize,ee.shadowCameraNear=j.camera.near,ee.shadowCameraFar=j.camera.far,n.pointShadow[p]=ee,n.pointShadowMap[p]=te,n.pointShadowMatrix[p]=P.shadow.matrix,E++}n.point[p]=V,p++}else if(P.isHemisphereLight){const V=e.get(P);V.skyColor.copy(P.color).multiplyScalar(Z),V.groundColor.copy(P.groundColor).multiplyScalar(Z),n.hemi[b]=V,b++}}A>0&&(s.has("OES_texture_float_linear")===!0?(n.rectAreaLTC1=ge.LTC_FLOAT_1,n.rectAreaLTC2=ge.LTC_FLOAT_2):(n.rectAreaLTC1=ge.LTC_HALF_1,n.rectAreaLTC2=ge.LTC_HALF_2)),n.ambient[0]=h,n.ambient[1]=u,n.ambient[2]=d;const I=n.hash;(I.sunLength!==f||I.directionalLength!==m||I.pointLength!==p||I.spotLength!==M||I.rectAreaLength!==A||I.hemiLength!==b||I.numSunShadows!==g||I.numDirectionalShadows!==R||I.numPointShadows!==E||I.numSpotShadows!==_||I.numSpotMaps!==y||I.numLightProbes!==N)&&(n.sun.length=f,n.directional.length=m,n.spot.length=M,n.rectArea.length=A,n.point.length=p,n.hemi.length=b,n.sunShadow.length=g,n.sunShadowMap.length=g,n.sunShadowMatrix.length=S,n.sunShadowCascade.length=S,n.directionalShadow.length=R,n.directionalShadowMap.length=R,n.directionalShadowMatrix.length=R,n.pointShadow.length=E,n.pointShadowMap.length=E,n.pointShadowMatrix.length=E,n.spotShadow.length=_,n.spotShadowMap.length=_,n.spotLightMatrix.length=_+y-k,n.spotLightMap.length=y,n.numSpotLightShadowsWithMaps=k,n.numLightProbes=N,I.sunLength=f,I.directionalLength=m,I.pointLength=p,I.spotLength=M,I.rectAreaLength=A,I.hemiLength=b,I.numSunShadows=g,I.numDirectionalShadows=R,I.numPointShadows=E,I.numSpotShadows=_,I.numSpotMaps=y,I.numLightProbes=N,n.version=Bf++)}function l(c,h){let u=0,d=0,f=0,g=0,S=0,m=0;const p=h.matrixWorldInverse;for(let M=0,A=c.length;M<A;M++){const b=c[M];if(b.isSunLight){const R=n.sun[u];R.direction.setFromMatrixPosition(b.matrixWorld),R.direction.transformDirection(p),u++}else if(b.isDirectionalLight){const R=n.directional[d];R.direction.setFromMatrixPosition(b.matrixWorld),i.setFromMatrixPosition(b.target.matrixWorld),R.direction.sub(i),R.direction.transformDirection(p),d++}else if(b.isSpotLight){const R=n.spot[g];R.position.setFromMatrixPosition(b.matrixWorld),R.position.applyMatrix4(p),R.direction.setFromMatrixPosition(b.matrixWorld),i.setFromMatrixPosition(b.target.matrixWorld),R.direction.sub(i),R.direction.transformDirection(p),g++}else if(b.isRectAreaLight){const R=n.rectArea[S];R.position.setFromMatrixPosition(b.matrixWorld),R.position.applyMatrix4(p),a.identity(),r.copy(b.matrixWorld),r.premultiply(p),a.extractRotation(r),R.halfWidth.set(b.width*.5,0,0),R.halfHeight.set(0,b.height*.5,0),R.halfWidth.applyMatrix4(a),R.halfHeight.applyMatrix4(a),S++}else if(b.isPointLight){const R=n.point[f];R.position.setFromMatrixPosition(b.matrixWorld),R.position.applyMatrix4(p),f++}else if(b.isHemisphereLight){const R=n.hemi[m];R.direction.setFromMatrixPosition(b.matrixWorld),R.direction.transformDirection(p),m++}}}return{setup:o,setupView:l,state:n}}function so(s){const e=new Gf(s),t=[],n=[],i=[];function r(u){h.camera=u,t.length=0,n.length=0,i.length=0}function a(u){u.isLightProbeGrid?i.push(u):t.push(u)}function o(u){n.push(u)}function l(){e.setup(t),i.sort((u,d)=>u.priority-d.priority||u.id-d.id)}function c(u){e.setupView(t,u)}const h={lightsArray:t,shadowsArray:n,lightProbeGridArray:i,camera:null,lights:e,transmissionRenderTarget:{},textureUnits:0};return{init:r,state:h,setupLights:l,setupLightsView:c,pushLight:a,pushShadow:o}}function zf(s){let e=new WeakMap;function t(i,r=0){const a=e.get(i);let o;return a===void 0?(o=new so(s),e.set(i,[o])):r>=a.length?(o=new so(s),a.push(o)):o=a[r],o}function n(){e=new WeakMap}return{get:t,dispose:n}}const Hf=`void main() {
	gl_Position = vec4( position, 1.0 );
}`,Vf=`uniform sampler2D shadow_pass;
uniform vec2 resolution;
uniform float radius;
void main() {
	const float samples = float( VSM_SAMPLES );
	float mean = 0.0;
	float squared_mean = 0.0;
	float uvStride = samples <= 1.0 ? 0.0 : 2.0 / ( samples - 1.0 );
	float uvStart = samples <= 1.0 ? 0.0 : - 1.0;
	for ( float i = 0.0; i < samples; i ++ ) {
		float uvOffset = uvStart + i * uvStride;
		#ifdef HORIZONTAL_PASS
			vec2 distribution = texture2D( shadow_pass, ( gl_FragCoord.xy + vec2( uvOffset, 0.0 ) * radius ) / resolution ).rg;
			mean += distribution.x;
			squared_mean += distribution.y * distribution.y + distribution.x * distribution.x;
		#else
			float depth = texture2D( shadow_pass, ( gl_FragCoord.xy + vec2( 0.0, uvOffset ) * radius ) / resolution ).r;
			mean += depth;
			squared_mean += depth * depth;
		#endif
	}
	mean = mean / samples;
	squared_mean = squared_mean / samples;
	float std_dev = sqrt( max( 0.0, squared_mean - mean * mean ) );
	gl_FragColor = vec4( mean, std_dev, 0.0, 1.0 );
}`,Wf=[new D(1,0,0),new D(-1,0,0),new D(0,1,0),new D(0,-1,0),new D(0,0,1),new D(0,0,-1)],Xf=[new D(0,-1,0),new D(0,-1,0),new D(0,0,1),new D(0,0,-1),new D(0,-1,0),new D(0,-1,0)],ro=new Qe,Pi=new D,wr=new D;function $f(s,e,t){let n=new Kn;const i=new Ye,r=new Ye,a=new gt,o=new ac,l=new oc,c={},h=t.maxTextureSize,u={0:1,1:0,2:2},d=new pn({defines:{VSM_SAMPLES:8},uniforms:{shadow_pass:{value:null},resolution:{value:new Ye},radius:{value:4}},vertexShader:Hf,fragmentShader:Vf}),f=d.clone();f.defines.HORIZONTAL_PASS=1;const g=new ht;g.setAttribute("position",new ct(new Float32Array([-1,-1,.5,3,-1,.5,-1,3,.5]),3));const S=new fn(g,d),m=this;this.enabled=!1,this.autoUpdate=!0,this.needsUpdate=!1,this.type=1;let p=this.type;this.render=function(E,_,y){if(m.enabled===!1||m.autoUpdate===!1&&m.needsUpdate===!1||E.length===0)return;this.type===2&&(Le("WebGLShadowMap: PCFSoftShadowMap has been removed. Using PCFShadowMap instead."),this.type=1);const k=s.getRenderTarget(),N=s.getActiveCubeFace(),I=s.getActiveMipmapLevel(),z=s.state;z.setBlending(0),z.buffers.depth.getReversed()===!0?z.buffers.color.setClear(0,0,0,0):z.buffers.color.setClear(1,1,1,1),z.buffers.depth.setTest(!0),z.setScissorTest(!1);const $=p!==this.type;$&&_.traverse(function(P){P.material&&(Array.isArray(P.material)?P.material.forEach(W=>W.needsUpdate=!0):P.material.needsUpdate=!0)});for(let P=0,W=E.length;P<W;P++){const Z=E[P],H=Z.shadow;if(H===void 0){Le("WebGLShadowMap:",Z,"has no shadow.");continue}if(H.autoUpdate===!1&&H.needsUpdate===!1)continue;i.copy(H.mapSize);const te=H.getFrameExtents();i.multiply(te),r.copy(H.mapSize),(i.x>h||i.y>h)&&(i.x>h&&(r.x=Math.floor(h/te.x),i.x=r.x*te.x,H.mapSize.x=r.x),i.y>h&&(r.y=Math.floor(h/te.y),i.y=r.y*te.y,H.mapSize.y=r.y));const V=s.state.buffers.depth.getReversed();if(H.camera._reversedDepth=V,H.map===null||$===!0){if(H.map!==null&&(H.map.depthTexture!==null&&(H.map.depthTexture.dispose(),H.map.depthTexture=null),H.map.dispose()),this.type===3){if(Z.isPointLight){Le("WebGLShadowMap: VSM shadow maps are not supported for PointLights. Use PCF or BasicShadowMap instead.");continue}H.map=new Zt(i.x,i.y,{format:1030,type:1016,minFilter:1006,magFilter:1006,generateMipmaps:!1}),H.map.texture.name=Z.name+".shadowMap",H.map.depthTexture=new Zn(i.x,i.y,1015),H.map.depthTexture.name=Z.name+".shadowMapDepth",H.map.depthTexture.format=1026,H.map.depthTexture.compareFunction=null,H.map.depthTexture.minFilter=1003,H.map.depthTexture.magFilter=1003}else Z.isPointLight?(H.map=new Xr(i.x),H.map.depthTexture=new Fo(i.x,1014)):(H.map=new Zt(i.x,i.y),H.map.depthTexture=new Zn(i.x,i.y,1014)),H.map.depthTexture.name=Z.name+".shadowMap",H.map.depthTexture.format=1026,this.type===1?(H.map.depthTexture.compareFunction=V?518:515,H.map.depthTexture.minFilter=1006,H.map.depthTexture.magFilter=1006):(H.map.depthTexture.compareFunction=null,H.map.depthTexture.minFilter=1003,H.map.depthTexture.magFilter=1003);H.camera.updateProjectionMatrix()}H.map.isWebGLCubeRenderTarget!==!0&&(H.map.width!==i.x||H.map.height!==i.y)&&H.map.setSize(i.x,i.y);const j=H.map.isWebGLCubeRenderTarget?6:H.getViewportCount();Z.isPointLight!==!0&&H.updateMatrices(Z,y);const ee=(H.camera.layers.mask&4294967294)!==0?H.camera.layers:y.layers;for(let we=0;we<j;we++){const Pe=H.getCamera(we);if(Z.isPointLight){const q=H.camera,he=H.matrix,ve=Z.distance||q.far;ve!==q.far&&(q.far=ve,q.updateProjectionMatrix()),Pi.setFromMatrixPosition(Z.matrixWorld),q.position.copy(Pi),wr.copy(q.position),wr.add(Wf[we]),q.up.copy(Xf[we]),q.lookAt(wr),q.updateMatrixWorld(),he.makeTranslation(-Pi.x,-Pi.y,-Pi.z),ro.multiplyMatrices(q.projectionMatrix,q.matrixWorldInverse),H._frustum.setFromProjectionMatrix(ro,q.coordinateSystem,q.reversedDepth)}if(H.map.isWebGLCubeRenderTarget)s.setRenderTarget(H.map,we),s.clear();else{we===0&&(s.setRenderTarget(H.map),s.clear());const q=H.getViewport(we);a.set(r.x*q.x,r.y*q.y,r.x*q.z,r.y*q.w),z.viewport(a)}n=H.getFrustum(we),b(_,y,Pe,Z,ee,this.type)}H.isPointLightShadow!==!0&&this.type===3&&M(H,y),H.needsUpdate=!1}p=this.type,m.needsUpdate=!1,s.setRenderTarget(k,N,I)};function M(E,_){const y=e.update(S);d.defines.VSM_SAMPLES!==E.blurSamples&&(d.defines.VSM_SAMPLES=E.blurSamples,f.defines.VSM_SAMPLES=E.blurSamples,d.needsUpdate=!0,f.needsUpdate=!0),E.mapPass===null?E.mapPass=new Zt(i.x,i.y,{format:1030,type:1016}):(E.mapPass.width!==E.map.width||E.mapPass.height!==E.map.height)&&E.mapPass.setSize(E.map.width,E.map.height),d.uniforms.shadow_pass.value=E.map.depthTexture,d.uniforms.resolution.value.set(E.map.width,E.map.height),d.uniforms.radius.value=E.radius,s.setRenderTarget(E.mapPass),s.clear(),s.renderBufferDirect(_,null,y,d,S,null),f.uniforms.shadow_pass.value=E.mapPass.texture,f.uniforms.resolution.value.set(E.map.width,E.map.height),f.uniforms.radius.value=E.radius,s.setRenderTarget(E.map),s.clear(),s.renderBufferDirect(_,null,y,f,S,null)}function A(E,_,y,k){let N=null;const I=y.isPointLight===!0?E.customDistanceMaterial:E.customDepthMaterial;if(I!==void 0)N=I;else if(N=y.isPointLight===!0?l:o,s.localClippingEnabled&&_.clipShadows===!0&&Array.isArray(_.clippingPlanes)&&_.clippingPlanes.length!==0||_.displacementMap&&_.displacementScale!==0||_.alphaMap&&_.alphaTest>0||_.map&&_.alphaTest>0||_.alphaToCoverage===!0){const z=N.uuid,$=_.uuid;let P=c[z];P===void 0&&(P={},c[z]=P);let W=P[$];W===void 0&&(W=N.clone(),P[$]=W,_.addEventListener("dispose",R)),N=W}if(N.visible=_.visible,N.wireframe=_.wireframe,k===3?N.side=_.shadowSide!==null?_.shadowSide:_.side:N.side=_.shadowSide!==null?_.shadowSide:u[_.side],N.alphaMap=_.alphaMap,N.alphaTest=_.alphaToCoverage===!0?.5:_.alphaTest,N.map=_.map,N.clipShadows=_.clipShadows,N.clippingPlanes=_.clippingPlanes,N.clipIntersection=_.clipIntersection,N.displacementMap=_.displacementMap,N.displacementScale=_.displacementScale,N.displacementBias=_.displacementBias,N.wireframeLinewidth=_.wireframeLinewidth,N.linewidth=_.linewidth,y.isPointLight===!0&&N.isMeshDistanceMaterial===!0){const z=s.properties.get(N);z.light=y}return N}function b(E,_,y,k,N,I){if(E.visible===!1)return;if(E.layers.test(N)&&(E.isMesh||E.isLine||E.isPoints)&&(E.castShadow||E.receiveShadow&&I===3)&&(!E.frustumCulled||E.intersectsFrustum(n))){E.modelViewMatrix.multiplyMatrices(y.matrixWorldInverse,E.matrixWorld);const P=e.update(E),W=E.material;if(Array.isArray(W)){const Z=P.groups;for(let H=0,te=Z.length;H<te;H++){const V=Z[H],j=W[V.materialIndex];if(j&&j.visible){const ee=A(E,j,k,I);E.onBeforeShadow(s,E,_,y,P,ee,V),s.renderBufferDirect(y,null,P,ee,E,V),E.onAfterShadow(s,E,_,y,P,ee,V)}}}else if(W.visible){const Z=A(E,W,k,I);E.onBeforeShadow(s,E,_,y,P,Z,null),s.renderBufferDirect(y,null,P,Z,E,null),E.onAfterShadow(s,E,_,y,P,Z,null)}}const $=E.children;for(let P=0,W=$.length;P<W;P++)b($[P],_,y,k,N,I)}function R(E){E.target.removeEventListener("dispose",R);for(const y in c){const k=c[y],N=E.target.uuid;N in k&&(k[N].dispose(),delete k[N])}}}function qf(s,e){function t(){let T=!1;const J=new gt;let X=null;const le=new gt(0,0,0,0);return{setMask:function(se){X!==se&&!T&&(s.colorMask(se,se,se,se),X=se)},setLocked:function(se){T=se},setClear:function(se,ae,be,ke,ie){ie===!0&&(se*=ke,ae*=ke,be*=ke),J.set(se,ae,be,ke),le.equals(J)===!1&&(s.clearColor(se,ae,be,ke),le.copy(J))},reset:function(){T=!1,X=null,le.set(-1,0,0,0)}}}function n(){let T=!1,J=!1,X=null,le=null,se=null;return{setReversed:function(ae){if(J!==ae){const be=e.get("EXT_clip_control");ae?be.clipControlEXT(be.LOWER_LEFT_EXT,be.ZERO_TO_ONE_EXT):be.clipControlEXT(be.LOWER_LEFT_EXT,be.NEGATIVE_ONE_TO_ONE_EXT),J=ae;const ke=se;se=null,this.setClear(ke)}},getReversed:function(){return J},setTest:function(ae){ae?fe(s.DEPTH_TEST):De(s.DEPTH_TEST)},setMask:function(ae){X!==ae&&!T&&(s.depthMask(ae),X=ae)},setFunc:function(ae){if(J&&(ae=Al[ae]),le!==ae){switch(ae){case 0:s.depthFunc(s.NEVER);break;case 1:s.depthFunc(s.ALWAYS);break;case 2:s.depthFunc(s.LESS);break;case 3:s.depthFunc(s.LEQUAL);break;case 4:s.depthFunc(s.EQUAL);break;case 5:s.depthFunc(s.GEQUAL);break;case 6:s.depthFunc(s.GREATER);break;case 7:s.depthFunc(s.NOTEQUAL);break;default:s.depthFunc(s.LEQUAL)}le=ae}},setLocked:function(ae){T=ae},setClear:function(ae){se!==ae&&(se=ae,J&&(ae=1-ae),s.clearDepth(ae))},reset:function(){T=!1,X=null,le=null,se=null,J=!1}}}function i(){let T=!1,J=null,X=null,le=null,se=null,ae=null,be=null,ke=null,ie=null;return{setTest:function(Re){T||(Re?fe(s.STENCIL_TEST):De(s.STENCIL_TEST))},setMask:function(Re){J!==Re&&!T&&(s.stencilMask(Re),J=Re)},setFunc:function(Re,Oe,me){(X!==Re||le!==Oe||se!==me)&&(s.stencilFunc(Re,Oe,me),X=Re,le=Oe,se=me)},setOp:function(Re,Oe,me){(ae!==Re||be!==Oe||ke!==me)&&(s.stencilOp(Re,Oe,me),ae=Re,be=Oe,ke=me)},setLocked:function(Re){T=Re},setClear:function(Re){ie!==Re&&(s.clearStencil(Re),ie=Re)},reset:function(){T=!1,J=null,X=null,le=null,se=null,ae=null,be=null,ke=null,ie=null}}}const r=new t,a=new n,o=new i;let l={};const c=new WeakMap;let h={},u={},d={},f=new WeakMap,g=[],S=null,m=!1,p=null,M=null,A=null,b=null,R=null,E=null,_=null,y=new Xe(0,0,0),k=0,N=!1,I=null,z=null,$=null,P=null,W=null;const Z=s.getParameter(s.MAX_COMBINED_TEXTURE_IMAGE_UNITS);let H=!1,te=0;const V=s.getParameter(s.VERSION);V.indexOf("WebGL")!==-1?(te=parseFloat(/^WebGL (\d)/.exec(V)[1]),H=te>=1):V.indexOf("OpenGL ES")!==-1&&(te=parseFloat(/^OpenGL ES (\d)/.exec(V)[1]),H=te>=2);let j=null,ee={};const we=s.getParameter(s.SCISSOR_BOX),Pe=s.getParameter(s.VIEWPORT),q=new gt().fromArray(we),he=new gt().fromArray(Pe);function ve(T,J,X,le){const se=new Uint8Array(4),ae=s.createTexture();s.bindTexture(T,ae),s.texParameteri(T,s.TEXTURE_MIN_FILTER,s.NEAREST),s.texParameteri(T,s.TEXTURE_MAG_FILTER,s.NEAREST);for(let be=0;be<X;be++)T===s.TEXTURE_3D||T===s.TEXTURE_2D_ARRAY?s.texImage3D(J,0,s.RGBA,1,1,le,0,s.RGBA,s.UNSIGNED_BYTE,se):s.texImage2D(J+be,0,s.RGBA,1,1,0,s.RGBA,s.UNSIGNED_BYTE,se);return ae}const Ee={};Ee[s.TEXTURE_2D]=ve(s.TEXTURE_2D,s.TEXTURE_2D,1),Ee[s.TEXTURE_CUBE_MAP]=ve(s.TEXTURE_CUBE_MAP,s.TEXTURE_CUBE_MAP_POSITIVE_X,6),Ee[s.TEXTURE_2D_ARRAY]=ve(s.TEXTURE_2D_ARRAY,s.TEXTURE_2D_ARRAY,1,1),Ee[s.TEXTURE_3D]=ve(s.TEXTURE_3D,s.TEXTURE_3D,1,1),r.setClear(0,0,0,1),a.setClear(1),o.setClear(0),fe(s.DEPTH_TEST),a.setFunc(3),Ut(!1),ot(1),fe(s.CULL_FACE),dt(0);function fe(T){h[T]!==!0&&(s.enable(T),h[T]=!0)}function De(T){h[T]!==!1&&(s.disable(T),h[T]=!1)}function Ke(T,J){return d[T]!==J?(s.bindFramebuffer(T,J),d[T]=J,T===s.DRAW_FRAMEBUFFER&&(d[s.FRAMEBUFFER]=J),T===s.FRAMEBUFFER&&(d[s.DRAW_FRAMEBUFFER]=J),!0):!1}function Te(T,J){let X=g,le=!1;if(T){X=f.get(J),X===void 0&&(X=[],f.set(J,X));const se=T.textures;if(X.length!==se.length||X[0]!==s.COLOR_ATTACHMENT0){for(let ae=0,be=se.length;ae<be;ae++)X[ae]=s.COLOR_ATTACHMENT0+ae;X.length=se.length,le=!0}}else X[0]!==s.BACK&&(X[0]=s.BACK,le=!0);le&&s.drawBuffers(X)}function He(T){return S!==T?(s.useProgram(T),S=T,!0):!1}const Ne={100:s.FUNC_ADD,101:s.FUNC_SUBTRACT,102:s.FUNC_REVERSE_SUBTRACT};Ne[103]=s.MIN,Ne[104]=s.MAX;const Be={200:s.ZERO,201:s.ONE,202:s.SRC_COLOR,204:s.SRC_ALPHA,210:s.SRC_ALPHA_SATURATE,208:s.DST_COLOR,206:s.DST_ALPHA,203:s.ONE_MINUS_SRC_COLOR,205:s.ONE_MINUS_SRC_ALPHA,209:s.ONE_MINUS_DST_COLOR,207:s.ONE_MINUS_DST_ALPHA,211:s.CONSTANT_COLOR,212:s.ONE_MINUS_CONSTANT_COLOR,213:s.CONSTANT_ALPHA,214:s.ONE_MINUS_CONSTANT_ALPHA};function dt(T,J,X,le,se,ae,be,ke,ie,Re){if(T===0){m===!0&&(De(s.BLEND),m=!1);return}if(m===!1&&(fe(s.BLEND),m=!0),T!==5){if(T!==p||Re!==N){if((M!==100||R!==100)&&(s.blendEquation(s.FUNC_ADD),M=100,R=100),Re)switch(T){case 1:s.blendFuncSeparate(s.ONE,s.ONE_MINUS_SRC_ALPHA,s.ONE,s.ONE_MINUS_SRC_ALPHA);break;case 2:s.blendFunc(s.ONE,s.ONE);break;case 3:s.blendFuncSeparate(s.ZERO,s.ONE_MINUS_SRC_COLOR,s.ZERO,s.ONE);break;case 4:s.blendFuncSeparate(s.DST_COLOR,s.ONE_MINUS_SRC_ALPHA,s.ZERO,s.ONE);break;default:Je("WebGLState: Invalid blending: ",T);break}else switch(T){case 1:s.blendFuncSeparate(s.SRC_ALPHA,s.ONE_MINUS_SRC_ALPHA,s.ONE,s.ONE_MINUS_SRC_ALPHA);break;case 2:s.blendFuncSeparate(s.SRC_ALPHA,s.ONE,s.ONE,s.ONE);break;case 3:Je("WebGLState: SubtractiveBlending requires material.premultipliedAlpha = true");break;case 4:Je("WebGLState: MultiplyBlending requires material.premultipliedAlpha = true");break;default:Je("WebGLState: Invalid blending: ",T);break}A=null,b=null,E=null,_=null,y.set(0,0,0),k=0,p=T,N=Re}return}se=se||J,ae=ae||X,be=be||le,(J!==M||se!==R)&&(s.blendEquationSeparate(Ne[J],Ne[se]),M=J,R=se),(X!==A||le!==b||ae!==E||be!==_)&&(s.blendFuncSeparate(Be[X],Be[le],Be[ae],Be[be]),A=X,b=le,E=ae,_=be),(ke.equals(y)===!1||ie!==k)&&(s.blendColor(ke.r,ke.g,ke.b,ie),y.copy(ke),k=ie),p=T,N=!1}function at(T,J){T.side===2?De(s.CULL_FACE):fe(s.CULL_FACE);let X=T.side===1;J&&(X=!X),Ut(X),T.blending===1&&T.transparent===!1?dt(0):dt(T.blending,T.blendEquation,T.blendSrc,T.blendDst,T.blendEquationAlpha,T.blendSrcAlpha,T.blendDstAlpha,T.blendColor,T.blendAlpha,T.premultipliedAlpha),a.setFunc(T.depthFunc),a.setTest(T.depthTest),a.setMask(T.depthWrite),r.setMask(T.colorWrite);const le=T.stencilWrite;o.setTest(le),le&&(o.setMask(T.stencilWriteMask),o.setFunc(T.stencilFunc,T.stencilRef,T.stencilFuncMask),o.setOp(T.stencilFail,T.stencilZFail,T.stencilZPass)),Mt(T.polygonOffset,T.polygonOffsetFactor,T.polygonOffsetUnits),T.alphaToCoverage===!0?fe(s.SAMPLE_ALPHA_TO_COVERAGE):De(s.SAMPLE_ALPHA_TO_COVERAGE)}function Ut(T){I!==T&&(T?s.frontFace(s.CW):s.frontFace(s.CCW),I=T)}function ot(T){T!==0?(fe(s.CULL_FACE),T!==z&&(T===1?s.cullFace(s.BACK):T===2?s.cullFace(s.FRONT):s.cullFace(s.FRONT_AND_BACK))):De(s.CULL_FACE),z=T}function an(T){T!==$&&(H&&s.lineWidth(T),$=T)}function Mt(T,J,X){T?(fe(s.POLYGON_OFFSET_FILL),(P!==J||W!==X)&&(P=J,W=X,a.getReversed()&&(J=-J,X=-X),s.polygonOffset(J,X))):De(s.POLYGON_OFFSET_FILL)}function Ht(T){T?fe(s.SCISSOR_TEST):De(s.SCISSOR_TEST)}function Vt(T){T===void 0&&(T=s.TEXTURE0+Z-1),j!==T&&(s.activeTexture(T),j=T)}function Wt(T,J,X){X===void 0&&(j===null?X=s.TEXTURE0+Z-1:X=j);let le=ee[X];le===void 0&&(le={type:void 0,texture:void 0},ee[X]=le),(le.type!==T||le.texture!==J)&&(j!==X&&(s.activeTexture(X),j=X),s.bindTexture(T,J||Ee[T]),le.type=T,le.texture=J)}function F(){const T=ee[j];T!==void 0&&T.type!==void 0&&(s.bindTexture(T.type,null),T.type=void 0,T.texture=void 0)}function Xt(){try{s.compressedTexImage2D(...arguments)}catch(T){Je("WebGLState:",T)}}function st(){try{s.compressedTexImage3D(...arguments)}catch(T){Je("WebGLState:",T)}}function rt(){try{s.texSubImage2D(...arguments)}catch(T){Je("WebGLState:",T)}}function pe(){try{s.texSubImage3D(...arguments)}catch(T){Je("WebGLState:",T)}}function _t(){try{s.compressedTexSubImage2D(...arguments)}catch(T){Je("WebGLState:",T)}}function Ce(){try{s.compressedTexSubImage3D(...arguments)}catch(T){Je("WebGLState:",T)}}function Fe(){try{s.texStorage2D(...arguments)}catch(T){Je("WebGLState:",T)}}function w(){try{s.texStorage3D(...arguments)}catch(T){Je("WebGLState:",T)}}function v(){try{s.texImage2D(...arguments)}catch(T){Je("WebGLState:",T)}}function O(){try{s.texImage3D(...arguments)}catch(T){Je("WebGLState:",T)}}function ne(T){return u[T]!==void 0?u[T]:s.getParameter(T)}function Q(T,J){u[T]!==J&&(s.pixelStorei(T,J),u[T]=J)}function re(T){q.equals(T)===!1&&(s.scissor(T.x,T.y,T.z,T.w),q.copy(T))}function de(T){he.equals(T)===!1&&(s.viewport(T.x,T.y,T.z,T.w),he.copy(T))}function Y(T,J){let X=c.get(J);X===void 0&&(X=new WeakMap,c.set(J,X));let le=X.get(T);le===void 0&&(le=s.getUniformBlockIndex(J,T.name),s.uniformBlockBinding(J,le,le),X.set(T,le))}function K(T,J,X){const se=c.get(J).get(T);l[se]!==X&&(s.bindBufferBase(s.UNIFORM_BUFFER,se,X),l[se]=X)}function oe(){s.disable(s.BLEND),s.disable(s.CULL_FACE),s.disable(s.DEPTH_TEST),s.disable(s.POLYGON_OFFSET_FILL),s.disable(s.SCISSOR_TEST),s.disable(s.STENCIL_TEST),s.disable(s.SAMPLE_ALPHA_TO_COVERAGE),s.blendEquation(s.FUNC_ADD),s.blendFunc(s.ONE,s.ZERO),s.blendFuncSeparate(s.ONE,s.ZERO,s.ONE,s.ZERO),s.blendColor(0,0,0,0),s.colorMask(!0,!0,!0,!0),s.clearColor(0,0,0,0),s.depthMask(!0),s.depthFunc(s.LESS),a.setReversed(!1),s.clearDepth(1),s.stencilMask(4294967295),s.stencilFunc(s.ALWAYS,0,4294967295),s.stencilOp(s.KEEP,s.KEEP,s.KEEP),s.clearStencil(0),s.cullFace(s.BACK),s.frontFace(s.CCW),s.polygonOffset(0,0),s.activeTexture(s.TEXTURE0),s.bindFramebuffer(s.FRAMEBUFFER,null),s.bindFramebuffer(s.DRAW_FRAMEBUFFER,null),s.bindFramebuffer(s.READ_FRAMEBUFFER,null),s.useProgram(null),s.lineWidth(1),s.scissor(0,0,s.canvas.width,s.canvas.height),s.viewport(0,0,s.canvas.width,s.canvas.height),s.pixelStorei(s.PACK_ALIGNMENT,4),s.pixelStorei(s.UNPACK_ALIGNMENT,4),s.pixelStorei(s.UNPACK_FLIP_Y_WEBGL,!1),s.pixelStorei(s.UNPACK_PREMULTIPLY_ALPHA_WEBGL,!1),s.pixelStorei(s.UNPACK_COLORSPACE_CONVERSION_WEBGL,s.BROWSER_DEFAULT_WEBGL),s.pixelStorei(s.PACK_ROW_LENGTH,0),s.pixelStorei(s.PACK_SKIP_PIXELS,0),s.pixelStorei(s.PACK_SKIP_ROWS,0),s.pixelStorei(s.UNPACK_ROW_LENGTH,0),s.pixelStorei(s.UNPACK_IMAGE_HEIGHT,0),s.pixelStorei(s.UNPACK_SKIP_PIXELS,0),s.pixelStorei(s.UNPACK_SKIP_ROWS,0),s.pixelStorei(s.UNPACK_SKIP_IMAGES,0),h={},u={},j=null,ee={},d={},l={},f=new WeakMap,g=[],S=null,m=!1,p=null,M=null,A=null,b=null,R=null,E=null,_=null,y=new Xe(0,0,0),k=0,N=!1,I=null,z=null,$=null,P=null,W=null,q.set(0,0,s.canvas.width,s.canvas.height),he.set(0,0,s.canvas.width,s.canvas.height),r.reset(),a.reset(),o.reset()}return{buffers:{color:r,depth:a,stencil:o},enable:fe,disable:De,bindFramebuffer:Ke,drawBuffers:Te,useProgram:He,setBlending:dt,setMaterial:at,setFlipSided:Ut,setCullFace:ot,setLineWidth:an,setPolygonOffset:Mt,setScissorTest:Ht,activeTexture:Vt,bindTexture:Wt,unbindTexture:F,compressedTexImage2D:Xt,compressedTexImage3D:st,texImage2D:v,texImage3D:O,pixelStorei:Q,getParameter:ne,updateUBOMapping:Y,uniformBlockBinding:K,texStorage2D:Fe,texStorage3D:w,texSubImage2D:rt,texSubImage3D:pe,compressedTexSubImage2D:_t,compressedTexSubImage3D:Ce,scissor:re,viewport:de,reset:oe}}function Yf(s,e,t,n,i,r,a){const o=e.has("WEBGL_multisampled_render_to_texture")?e.get("WEBGL_multisampled_render_to_texture"):null,l=typeof navigator>"u"?!1:/OculusBrowser/g.test(navigator.userAgent),c=new Ye,h=new WeakMap,u=new Set;let d;const f=new WeakMap,g=new Set,S=new FinalizationRegistry(w=>g.delete(w));let m=!1;try{m=typeof OffscreenCanvas<"u"&&new OffscreenCanvas(1,1).getContext("2d")!==null}catch{}function p(w,v){return m?new OffscreenCanvas(w,v):Ns("canvas")}function M(w,v,O){let ne=1;const Q=Fe(w);if((Q.width>O||Q.height>O)&&(ne=O/Math.max(Q.width,Q.height)),ne<1)if(typeof HTMLImageElement<"u"&&w instanceof HTMLImageElement||typeof HTMLCanvasElement<"u"&&w instanceof HTMLCanvasElement||typeof ImageBitmap<"u"&&w instanceof ImageBitmap||typeof VideoFrame<"u"&&w instanceof VideoFrame){const re=Math.floor(ne*Q.width),de=Math.floor(ne*Q.height);d===void 0&&(d=p(re,de));const Y=v?p(re,de):d;return Y.width=re,Y.height=de,Y.getContext("2d").drawImage(w,0,0,re,de),Le("WebGLRenderer: Texture has been resized from ("+Q.width+"x"+Q.height+") to ("+re+"x"+de+")."),Y}else return"data"in w&&Le("WebGLRenderer: Image in DataTexture is too big ("+Q.width+"x"+Q.height+")."),w;return w}function A(w){return w.generateMipmaps}function b(w){s.generateMipmap(w)}function R(w){return w.isWebGLCubeRenderTarget?s.TEXTURE_CUBE_MAP:w.isWebGL3DRenderTarget?s.TEXTURE_3D:w.isWebGLArrayRenderTarget||w.isCompressedArrayTexture?s.TEXTURE_2D_ARRAY:s.TEXTURE_2D}function E(w,v,O,ne,Q,re=!1){if(w!==null){if(s[w]!==void 0)return s[w];Le("WebGLRenderer: Attempt to use non-existing WebGL internal format '"+w+"'")}let de;ne&&(de=e.get("EXT_texture_norm16"),de||Le("WebGLRenderer: Unable to use normalized textures without EXT_texture_norm16 extension"));let Y=v;if(v===s.RED&&(O===s.FLOAT&&(Y=s.R32F),O===s.HALF_FLOAT&&(Y=s.R16F),O===s.UNSIGNED_BYTE&&(Y=s.R8),O===s.UNSIGNED_SHORT&&de&&(Y=de.R16_EXT),O===s.SHORT&&de&&(Y=de.R16_SNORM_EXT)),v===s.RED_INTEGER&&(O===s.UNSIGNED_BYTE&&(Y=s.R8UI),O===s.UNSIGNED_SHORT&&(Y=s.R16UI),O===s.UNSIGNED_INT&&(Y=s.R32UI),O===s.BYTE&&(Y=s.R8I),O===s.SHORT&&(Y=s.R16I),O===s.INT&&(Y=s.R32I)),v===s.RG&&(O===s.FLOAT&&(Y=s.RG32F),O===s.HALF_FLOAT&&(Y=s.RG16F),O===s.UNSIGNED_BYTE&&(Y=s.RG8),O===s.UNSIGNED_SHORT&&de&&(Y=de.RG16_EXT),O===s.SHORT&&de&&(Y=de.RG16_SNORM_EXT)),v===s.RG_INTEGER&&(O===s.UNSIGNED_BYTE&&(Y=s.RG8UI),O===s.UNSIGNED_SHORT&&(Y=s.RG16UI),O===s.UNSIGNED_INT&&(Y=s.RG32UI),O===s.BYTE&&(Y=s.RG8I),O===s.SHORT&&(Y=s.RG16I),O===s.INT&&(Y=s.RG32I)),v===s.RGB_INTEGER&&(O===s.UNSIGNED_BYTE&&(Y=s.RGB8UI),O===s.UNSIGNED_SHORT&&(Y=s.RGB16UI),O===s.UNSIGNED_INT&&(Y=s.RGB32UI),O===s.BYTE&&(Y=s.RGB8I),O===s.SHORT&&(Y=s.RGB16I),O===s.INT&&(Y=s.RGB32I)),v===s.RGBA_INTEGER&&(O===s.UNSIGNED_BYTE&&(Y=s.RGBA8UI),O===s.UNSIGNED_SHORT&&(Y=s.RGBA16UI),O===s.UNSIGNED_INT&&(Y=s.RGBA32UI),O===s.BYTE&&(Y=s.RGBA8I),O===s.SHORT&&(Y=s.RGBA16I),O===s.INT&&(Y=s.RGBA32I)),v===s.RGB&&(O===s.UNSIGNED_SHORT&&de&&(Y=de.RGB16_EXT),O===s.SHORT&&de&&(Y=de.RGB16_SNORM_EXT),O===s.UNSIGNED_INT_5_9_9_9_REV&&(Y=s.RGB9_E5),O===s.UNSIGNED_INT_10F_11F_11F_REV&&(Y=s.R11F_G11F_B10F)),v===s.RGBA){const K=re?Ds:qe.getTransfer(Q);O===s.FLOAT&&(Y=s.RGBA32F),O===s.HALF_FLOAT&&(Y=s.RGBA16F),O===s.UNSIGNED_BYTE&&(Y=K===tt?s.SRGB8_ALPHA8:s.RGBA8),O===s.UNSIGNED_SHORT&&de&&(Y=de.RGBA16_EXT),O===s.SHORT&&de&&(Y=de.RGBA16_SNORM_EXT),O===s.UNSIGNED_SHORT_4_4_4_4&&(Y=s.RGBA4),O===s.UNSIGNED_SHORT_5_5_5_1&&(Y=s.RGB5_A1)}return(Y===s.R16F||Y===s.R32F||Y===s.RG16F||Y===s.RG32F||Y===s.RGBA16F||Y===s.RGBA32F)&&e.get("EXT_color_buffer_float"),Y}function _(w,v){let O;return w?v===null||v===1014||v===1020?O=s.DEPTH24_STENCIL8:v===1015?O=s.DEPTH32F_STENCIL8:v===1012&&(O=s.DEPTH24_STENCIL8,Le("DepthTexture: 16 bit depth attachment is not supported with stencil. Using 24-bit attachment.")):v===null||v===1014||v===1020?O=s.DEPTH_COMPONENT24:v===1015?O=s.DEPTH_COMPONENT32F:v===1012&&(O=s.DEPTH_COMPONENT16),O}function y(w,v){return A(w)===!0||w.isFramebufferTexture&&w.minFilter!==1003&&w.minFilter!==1006?Math.log2(Math.max(v.width,v.height))+1:w.mipmaps.length>0?w.mipmaps.length:w.isCompressedTexture&&Array.isArray(w.image)?v.mipmaps.length:1}function k(w){const v=new WeakRef(w);n.get(w).__ref=v,g.add(v),S.register(w,v,v)}function N(w){const v=n.get(w).__ref;v!==void 0&&(g.delete(v),S.unregister(v))}function I(w){$(w.target)}function z(w){P(w.target)}function $(w){w.removeEventListener("dispose",I),N(w),Z(w),w.isVideoTexture&&h.delete(w),w.isHTMLTexture&&u.delete(w)}function P(w){w.removeEventListener("dispose",z),N(w),te(w)}function W(){for(const w of g){const v=w.deref();v!==void 0&&(v.isRenderTarget===!0?P(v):$(v))}g.clear(),u.clear()}function Z(w){const v=n.get(w);if(v.__webglInit===void 0)return;const O=w.source,ne=f.get(O);if(ne){const Q=ne[v.__cacheKey];Q.usedTimes--,Q.usedTimes===0&&H(w),Object.keys(ne).length===0&&f.delete(O)}n.remove(w)}function H(w){const v=n.get(w);s.deleteTexture(v.__webglTexture);const O=w.source,ne=f.get(O);delete ne[v.__cacheKey],a.memory.textures--}function te(w){const v=n.get(w);v.__depthDisposeCallback&&v.__depthDisposeCallback();const O=w.depthTexture;if(O&&O.renderTarget===w&&$(O),w.isWebGLCubeRenderTarget)for(let Q=0;Q<6;Q++){if(Array.isArray(v.__webglFramebuffer[Q]))for(let re=0;re<v.__webglFramebuffer[Q].length;re++)s.deleteFramebuffer(v.__webglFramebuffer[Q][re]);else s.deleteFramebuffer(v.__webglFramebuffer[Q]);v.__webglDepthbuffer&&s.deleteRenderbuffer(v.__webglDepthbuffer[Q])}else{if(Array.isArray(v.__webglFramebuffer))for(let Q=0;Q<v.__webglFramebuffer.length;Q++)s.deleteFramebuffer(v.__webglFramebuffer[Q]);else s.deleteFramebuffer(v.__webglFramebuffer);if(v.__webglDepthbuffer&&s.deleteRenderbuffer(v.__webglDepthbuffer),v.__webglMultisampledFramebuffer&&s.deleteFramebuffer(v.__webglMultisampledFramebuffer),v.__webglColorRenderbuffer)for(let Q=0;Q<v.__webglColorRenderbuffer.length;Q++)v.__webglColorRenderbuffer[Q]&&s.deleteRenderbuffer(v.__webglColorRenderbuffer[Q]);v.__webglDepthRenderbuffer&&s.deleteRenderbuffer(v.__webglDepthRenderbuffer)}const ne=w.textures;for(let Q=0,re=ne.length;Q<re;Q++){const de=n.get(ne[Q]);de.__webglTexture&&(s.deleteTexture(de.__webglTexture),a.memory.textures--),n.remove(ne[Q])}n.remove(w)}let V=0;function j(){V=0}function ee(){return V}function we(w){V=w}function Pe(){const w=V;return w>=i.maxTextures&&Le("WebGLTextures: Trying to use "+(w+1)+" texture units while this GPU supports only "+i.maxTextures),V+=1,w}function q(w){const v=[];return v.push(w.wrapS),v.push(w.wrapT),v.push(w.wrapR||0),v.push(w.magFilter),v.push(w.minFilter),v.push(w.anisotropy),v.push(w.internalFormat),v.push(w.format),v.push(w.type),v.push(w.generateMipmaps),v.push(w.mipmapsAutoUpdate),v.push(w.premultiplyAlpha),v.push(w.flipY),v.push(w.unpackAlignment),v.push(w.colorSpace),v.join()}function he(w,v){const O=n.get(w);if(w.isVideoTexture&&_t(w),w.isRenderTargetTexture===!1&&w.isExternalTexture!==!0&&w.version>0&&O.__version!==w.version){const ne=w.image;if(ne===null)Le("WebGLRenderer: Texture marked for update but no image data found.");else if(ne.complete===!1)Le("WebGLRenderer: Texture marked for update but image is incomplete");else{at(O,w,v);return}}else w.isExternalTexture&&(O.__webglTexture=w.sourceTexture?w.sourceTexture:null);t.bindTexture(s.TEXTURE_2D,O.__webglTexture,s.TEXTURE0+v)}function ve(w,v){const O=n.get(w);if(w.isRenderTargetTexture===!1&&w.version>0&&O.__version!==w.version){at(O,w,v);return}else w.isExternalTexture&&(O.__webglTexture=w.sourceTexture?w.sourceTexture:null);t.bindTexture(s.TEXTURE_2D_ARRAY,O.__webglTexture,s.TEXTURE0+v)}function Ee(w,v){const O=n.get(w);if(w.isRenderTargetTexture===!1&&w.version>0&&O.__version!==w.version){at(O,w,v);return}t.bindTexture(s.TEXTURE_3D,O.__webglTexture,s.TEXTURE0+v)}function fe(w,v){const O=n.get(w);if(w.version>0&&O.__version!==w.version){Ut(O,w,v);return}t.bindTexture(s.TEXTURE_CUBE_MAP,O.__webglTexture,s.TEXTURE0+v)}const De={1e3:s.REPEAT,1001:s.CLAMP_TO_EDGE,1002:s.MIRRORED_REPEAT},Ke={1003:s.NEAREST,1004:s.NEAREST_MIPMAP_NEAREST,1005:s.NEAREST_MIPMAP_LINEAR,1006:s.LINEAR,1007:s.LINEAR_MIPMAP_NEAREST,1008:s.LINEAR_MIPMAP_LINEAR},Te={512:s.NEVER,519:s.ALWAYS,513:s.LESS,515:s.LEQUAL,514:s.EQUAL,518:s.GEQUAL,516:s.GREATER,517:s.NOTEQUAL};function He(w,v){if(v.type===1015&&e.has("OES_texture_float_linear")===!1&&(v.magFilter===1006||v.magFilter===1007||v.magFilter===1005||v.magFilter===1008||v.minFilter===1006||v.minFilter===1007||v.minFilter===1005||v.minFilter===1008)&&Le("WebGLRenderer: Unable to use linear filtering with floating point textures. OES_texture_float_linear not supported on this device."),s.texParameteri(w,s.TEXTURE_WRAP_S,De[v.wrapS]),s.texParameteri(w,s.TEXTURE_WRAP_T,De[v.wrapT]),(w===s.TEXTURE_3D||w===s.TEXTURE_2D_ARRAY)&&s.texParameteri(w,s.TEXTURE_WRAP_R,De[v.wrapR]),s.texParameteri(w,s.TEXTURE_MAG_FILTER,Ke[v.magFilter]),s.texParameteri(w,s.TEXTURE_MIN_FILTER,Ke[v.minFilter]),v.compareFunction&&(s.texParameteri(w,s.TEXTURE_COMPARE_MODE,s.COMPARE_REF_TO_TEXTURE),s.texParameteri(w,s.TEXTURE_COMPARE_FUNC,Te[v.compareFunction])),e.has("EXT_texture_filter_anisotropic")===!0){if(v.magFilter===1003||v.minFilter!==1005&&v.minFilter!==1008||v.type===1015&&e.has("OES_texture_float_linear")===!1)return;if(v.anisotropy>1||n.get(v).__currentAnisotropy){const O=e.get("EXT_texture_filter_anisotropic");s.texParameterf(w,O.TEXTURE_MAX_ANISOTROPY_EXT,Math.min(v.anisotropy,i.getMaxAnisotropy())),n.get(v).__currentAnisotropy=v.anisotropy}}}function Ne(w,v){let O=!1;w.__webglInit===void 0&&(w.__webglInit=!0,v.addEventListener("dispose",I),k(v));const ne=v.source;let Q=f.get(ne);Q===void 0&&(Q={},f.set(ne,Q));const re=q(v);if(re!==w.__cacheKey){Q[re]===void 0&&(Q[re]={texture:s.createTexture(),usedTimes:0},a.memory.textures++,O=!0),Q[re].usedTimes++;const de=Q[w.__cacheKey];de!==void 0&&(Q[w.__cacheKey].usedTimes--,de.usedTimes===0&&H(v)),w.__cacheKey=re,w.__webglTexture=Q[re].texture}return O}function Be(w,v,O){return Math.floor(Math.floor(w/O)/v)}function dt(w,v,O,ne){const re=w.updateRanges;if(re.length===0)t.texSubImage2D(s.TEXTURE_2D,0,0,0,v.width,v.height,O,ne,v.data);else{re.sort((T,J)=>T.start-J.start);let de=0;for(let T=1;T<re.length;T++){const J=re[de],X=re[T],le=J.start+J.count,se=Be(X.start,v.width,4),ae=Be(J.start,v.width,4);X.start<=le+1&&se===ae&&Be(X.start+X.count-1,v.width,4)===se?J.count=Math.max(J.count,X.start+X.count-J.start):(++de,re[de]=X)}re.length=de+1;const Y=t.getParameter(s.UNPACK_ROW_LENGTH),K=t.getParameter(s.UNPACK_SKIP_PIXELS),oe=t.getParameter(s.UNPACK_SKIP_ROWS);t.pixelStorei(s.UNPACK_ROW_LENGTH,v.width);for(let T=0,J=re.length;T<J;T++){const X=re[T],le=Math.floor(X.start/4),se=Math.ceil(X.count/4),ae=le%v.width,be=Math.floor(le/v.width),ke=se,ie=1;t.pixelStorei(s.UNPACK_SKIP_PIXELS,ae),t.pixelStorei(s.UNPACK_SKIP_ROWS,be),t.texSubImage2D(s.TEXTURE_2D,0,ae,be,ke,ie,O,ne,v.data)}w.clearUpdateRanges(),t.pixelStorei(s.UNPACK_ROW_LENGTH,Y),t.pixelStorei(s.UNPACK_SKIP_PIXELS,K),t.pixelStorei(s.UNPACK_SKIP_ROWS,oe)}}function at(w,v,O){let ne=s.TEXTURE_2D;(v.isDataArrayTexture||v.isCompressedArrayTexture)&&(ne=s.TEXTURE_2D_ARRAY),v.isData3DTexture&&(ne=s.TEXTURE_3D);const Q=Ne(w,v),re=v.source;t.bindTexture(ne,w.__webglTexture,s.TEXTURE0+O);const de=n.get(re);if(re.version!==de.__version||Q===!0){if(t.activeTexture(s.TEXTURE0+O),(typeof ImageBitmap<"u"&&v.image instanceof ImageBitmap)===!1){const ie=qe.getPrimaries(qe.workingColorSpace),Re=v.colorSpace===""?null:qe.getPrimaries(v.colorSpace),Oe=v.colorSpace===""||ie===Re?s.NONE:s.BROWSER_DEFAULT_WEBGL;t.pixelStorei(s.UNPACK_FLIP_Y_WEBGL,v.flipY),t.pixelStorei(s.UNPACK_PREMULTIPLY_ALPHA_WEBGL,v.premultiplyAlpha),t.pixelStorei(s.UNPACK_COLORSPACE_CONVERSION_WEBGL,Oe)}t.pixelStorei(s.UNPACK_ALIGNMENT,v.unpackAlignment);let K=M(v.image,!1,i.maxTextureSize);K=Ce(v,K);const oe=r.convert(v.format,v.colorSpace),T=r.convert(v.type);let J=E(v.internalFormat,oe,T,v.normalized,v.colorSpace,v.isVideoTexture);He(ne,v);let X;const le=v.mipmaps,se=v.isVideoTexture!==!0,ae=de.__version===void 0||Q===!0,be=re.dataReady,ke=y(v,K);if(v.isDepthTexture)J=_(v.format===1027,v.type),ae&&(se?t.texStorage2D(s.TEXTURE_2D,1,J,K.width,K.height):t.texImage2D(s.TEXTURE_2D,0,J,K.width,K.height,0,oe,T,null));else if(v.isDataTexture)if(le.length>0){se&&ae&&t.texStorage2D(s.TEXTURE_2D,ke,J,le[0].width,le[0].height);for(let ie=0,Re=le.length;ie<Re;ie++)X=le[ie],se?be&&t.texSubImage2D(s.TEXTURE_2D,ie,0,0,X.width,X.height,oe,T,X.data):t.texImage2D(s.TEXTURE_2D,ie,J,X.width,X.height,0,oe,T,X.data);v.generateMipmaps=!1}else se?(ae&&t.texStorage2D(s.TEXTURE_2D,ke,J,K.width,K.height),be&&dt(v,K,oe,T)):t.texImage2D(s.TEXTURE_2D,0,J,K.width,K.height,0,oe,T,K.data);else if(v.isCompressedTexture)if(v.isCompressedArrayTexture){se&&ae&&t.texStorage3D(s.TEXTURE_2D_ARRAY,ke,J,le[0].width,le[0].height,K.depth);for(let ie=0,Re=le.length;ie<Re;ie++)if(X=le[ie],v.format!==1023)if(oe!==null)if(se){if(be)if(v.layerUpdates.size>0){const Oe=Ba(X.width,X.height,v.format,v.type);for(const me of v.layerUpdates){const et=X.data.subarray(me*Oe/X.data.BYTES_PER_ELEMENT,(me+1)*Oe/X.data.BYTES_PER_ELEMENT);t.compressedTexSubImage3D(s.TEXTURE_2D_ARRAY,ie,0,0,me,X.width,X.height,1,oe,et)}}else t.compressedTexSubImage3D(s.TEXTURE_2D_ARRAY,ie,0,0,0,X.width,X.height,K.depth,oe,X.data)}else t.compressedTexImage3D(s.TEXTURE_2D_ARRAY,ie,J,X.width,X.height,K.depth,0,X.data,0,0);else Le("WebGLRenderer: Attempt to load unsupported compressed texture format in .uploadTexture()");else se?be&&t.texSubImage3D(s.TEXTURE_2D_ARRAY,ie,0,0,0,X.width,X.height,K.depth,oe,T,X.data):t.texImage3D(s.TEXTURE_2D_ARRAY,ie,J,X.width,X.height,K.depth,0,oe,T,X.data);v.layerUpdates.size>0&&v.clearLayerUpdates()}else{se&&ae&&t.texStorage2D(s.TEXTURE_2D,ke,J,le[0].width,le[0].height);for(let ie=0,Re=le.length;ie<Re;ie++)X=le[ie],v.format!==1023?oe!==null?se?be&&t.compressedTexSubImage2D(s.TEXTURE_2D,ie,0,0,X.width,X.height,oe,X.data):t.compressedTexImage2D(s.TEXTURE_2D,ie,J,X.width,X.height,0,X.data):Le("WebGLRenderer: Attempt to load unsupported compressed texture format in .uploadTexture()"):se?be&&t.texSubImage2D(s.TEXTURE_2D,ie,0,0,X.width,X.height,oe,T,X.data):t.texImage2D(s.TEXTURE_2D,ie,J,X.width,X.height,0,oe,T,X.data)}else if(v.isDataArrayTexture)if(se){if(ae&&t.texStorage3D(s.TEXTURE_2D_ARRAY,ke,J,K.width,K.height,K.depth),be)if(v.layerUpdates.size>0){const ie=Ba(K.width,K.height,v.format,v.type);for(const Re of v.layerUpdates){const Oe=K.data.subarray(Re*ie/K.data.BYTES_PER_ELEMENT,(Re+1)*ie/K.data.BYTES_PER_ELEMENT);t.texSubImage3D(s.TEXTURE_2D_ARRAY,0,0,0,Re,K.width,K.height,1,oe,T,Oe)}v.clearLayerUpdates()}else t.texSubImage3D(s.TEXTURE_2D_ARRAY,0,0,0,0,K.width,K.height,K.depth,oe,T,K.data)}else t.texImage3D(s.TEXTURE_2D_ARRAY,0,J,K.width,K.height,K.depth,0,oe,T,K.data);else if(v.isData3DTexture)se?(ae&&t.texStorage3D(s.TEXTURE_3D,ke,J,K.width,K.height,K.depth),be&&t.texSubImage3D(s.TEXTURE_3D,0,0,0,0,K.width,K.height,K.depth,oe,T,K.data)):t.texImage3D(s.TEXTURE_3D,0,J,K.width,K.height,K.depth,0,oe,T,K.data);else if(v.isFramebufferTexture){if(ae)if(se)t.texStorage2D(s.TEXTURE_2D,ke,J,K.width,K.height);else{let ie=K.width,Re=K.height;for(let Oe=0;Oe<ke;Oe++)t.texImage2D(s.TEXTURE_2D,Oe,J,ie,Re,0,oe,T,null),ie>>=1,Re>>=1}}else if(v.isHTMLTexture){if("texElementImage2D"in s){const ie=s.canvas;if(ie.hasAttribute("layoutsubtree")||ie.setAttribute("layoutsubtree","true"),K.parentNode!==ie){ie.appendChild(K),u.add(v),ie.onpaint=Re=>{const Oe=Re.changedElements;for(const me of u)Oe.includes(me.image)&&(me.needsUpdate=!0)},ie.requestPaint();return}if(s.texElementImage2D.length===3)s.texElementImage2D(s.TEXTURE_2D,s.RGBA8,K);else{const Oe=s.RGBA,me=s.RGBA,et=s.UNSIGNED_BYTE;s.texElementImage2D(s.TEXTURE_2D,0,Oe,me,et,K)}s.texParameteri(s.TEXTURE_2D,s.TEXTURE_MIN_FILTER,s.LINEAR),s.texParameteri(s.TEXTURE_2D,s.TEXTURE_WRAP_S,s.CLAMP_TO_EDGE),s.texParameteri(s.TEXTURE_2D,s.TEXTURE_WRAP_T,s.CLAMP_TO_EDGE)}}else if(le.length>0){if(se&&ae){const ie=Fe(le[0]);t.texStorage2D(s.TEXTURE_2D,ke,J,ie.width,ie.height)}for(let ie=0,Re=le.length;ie<Re;ie++)X=le[ie],se?be&&t.texSubImage2D(s.TEXTURE_2D,ie,0,0,oe,T,X):t.texImage2D(s.TEXTURE_2D,ie,J,oe,T,X);v.generateMipmaps=!1}else if(se){if(ae){const ie=Fe(K);t.texStorage2D(s.TEXTURE_2D,ke,J,ie.width,ie.height)}be&&t.texSubImage2D(s.TEXTURE_2D,0,0,0,oe,T,K)}else t.texImage2D(s.TEXTURE_2D,0,J,oe,T,K);A(v)&&v.mipmapsAutoUpdate===!0&&b(ne),de.__version=re.version,v.onUpdate&&v.onUpdate(v)}w.__version=v.version}function Ut(w,v,O){if(v.image.length!==6)return;const ne=Ne(w,v),Q=v.source;t.bindTexture(s.TEXTURE_CUBE_MAP,w.__webglTexture,s.TEXTURE0+O);const re=n.get(Q);if(Q.version!==re.__version||ne===!0){t.activeTexture(s.TEXTURE0+O);const de=qe.getPrimaries(qe.workingColorSpace),Y=v.colorSpace===""?null:qe.getPrimaries(v.colorSpace),K=v.colorSpace===""||de===Y?s.NONE:s.BROWSER_DEFAULT_WEBGL;t.pixelStorei(s.UNPACK_FLIP_Y_WEBGL,v.flipY),t.pixelStorei(s.UNPACK_PREMULTIPLY_ALPHA_WEBGL,v.premultiplyAlpha),t.pixelStorei(s.UNPACK_ALIGNMENT,v.unpackAlignment),t.pixelStorei(s.UNPACK_COLORSPACE_CONVERSION_WEBGL,K);const oe=v.isCompressedTexture||v.image[0].isCompressedTexture,T=v.image[0]&&v.image[0].isDataTexture,J=[];for(let me=0;me<6;me++)!oe&&!T?J[me]=M(v.image[me],!0,i.maxCubemapSize):J[me]=T?v.image[me].image:v.image[me],J[me]=Ce(v,J[me]);const X=J[0],le=r.convert(v.format,v.colorSpace),se=r.convert(v.type);let ae=E(v.internalFormat,le,se,v.normalized,v.colorSpace);const be=v.isVideoTexture!==!0,ke=re.__version===void 0||ne===!0,ie=Q.dataReady;let Re=y(v,X);He(s.TEXTURE_CUBE_MAP,v);let Oe;if(v.isDepthTexture){if(ae=_(v.format===1027,v.type),ke)if(be)t.texStorage2D(s.TEXTURE_CUBE_MAP,1,ae,X.width,X.height);else for(let me=0;me<6;me++)t.texImage2D(s.TEXTURE_CUBE_MAP_POSITIVE_X+me,0,ae,X.width,X.height,0,le,se,null)}else if(oe){be&&ke&&t.texStorage2D(s.TEXTURE_CUBE_MAP,Re,ae,X.width,X.height);for(let me=0;me<6;me++){Oe=J[me].mipmaps;for(let et=0;et<Oe.length;et++){const wt=Oe[et];v.format!==1023?le!==null?be?ie&&t.compressedTexSubImage2D(s.TEXTURE_CUBE_MAP_POSITIVE_X+me,et,0,0,wt.width,wt.height,le,wt.data):t.compressedTexImage2D(s.TEXTURE_CUBE_MAP_POSITIVE_X+me,et,ae,wt.width,wt.height,0,wt.data):Le("WebGLRenderer: Attempt to load unsupported compressed texture format in .setTextureCube()"):be?ie&&t.texSubImage2D(s.TEXTURE_CUBE_MAP_POSITIVE_X+me,et,0,0,wt.width,wt.height,le,se,wt.data):t.texImage2D(s.TEXTURE_CUBE_MAP_POSITIVE_X+me,et,ae,wt.width,wt.height,0,le,se,wt.data)}}}else{if(Oe=v.mipmaps,be&&ke){Oe.length>0&&Re++;const me=Fe(J[0]);t.texStorage2D(s.TEXTURE_CUBE_MAP,Re,ae,me.width,me.height)}for(let me=0;me<6;me++)if(T){be?ie&&t.texSubImage2D(s.TEXTURE_CUBE_MAP_POSITIVE_X+me,0,0,0,J[me].width,J[me].height,le,se,J[me].data):t.texImage2D(s.TEXTURE_CUBE_MAP_POSITIVE_X+me,0,ae,J[me].width,J[me].height,0,le,se,J[me].data);for(let et=0;et<Oe.length;et++){const An=Oe[et].image[me].image;be?ie&&t.texSubImage2D(s.TEXTURE_CUBE_MAP_POSITIVE_X+me,et+1,0,0,An.width,An.height,le,se,An.data):t.texImage2D(s.TEXTURE_CUBE_MAP_POSITIVE_X+me,et+1,ae,An.width,An.height,0,le,se,An.data)}}else{be?ie&&t.texSubImage2D(s.TEXTURE_CUBE_MAP_POSITIVE_X+me,0,0,0,le,se,J[me]):t.texImage2D(s.TEXTURE_CUBE_MAP_POSITIVE_X+me,0,ae,le,se,J[me]);for(let et=0;et<Oe.length;et++){const wt=Oe[et];be?ie&&t.texSubImage2D(s.TEXTURE_CUBE_MAP_POSITIVE_X+me,et+1,0,0,le,se,wt.image[me]):t.texImage2D(s.TEXTURE_CUBE_MAP_POSITIVE_X+me,et+1,ae,le,se,wt.image[me])}}}A(v)&&v.mipmapsAutoUpdate===!0&&b(s.TEXTURE_CUBE_MAP),re.__version=Q.version,v.onUpdate&&v.onUpdate(v)}w.__version=v.version}function ot(w,v,O,ne,Q,re){const de=r.convert(O.format,O.colorSpace),Y=r.convert(O.type),K=E(O.internalFormat,de,Y,O.normalized,O.colorSpace),oe=n.get(v),T=n.get(O);if(T.__renderTarget=v,!oe.__hasExternalTextures){const J=Math.max(1,v.width>>re),X=Math.max(1,v.height>>re);Q===s.TEXTURE_3D||Q===s.TEXTURE_2D_ARRAY?t.texImage3D(Q,re,K,J,X,v.depth,0,de,Y,null):t.texImage2D(Q,re,K,J,X,0,de,Y,null)}t.bindFramebuffer(s.FRAMEBUFFER,w),pe(v)?o.framebufferTexture2DMultisampleEXT(s.FRAMEBUFFER,ne,Q,T.__webglTexture,0,rt(v)):(Q===s.TEXTURE_2D||Q>=s.TEXTURE_CUBE_MAP_POSITIVE_X&&Q<=s.TEXTURE_CUBE_MAP_NEGATIVE_Z)&&s.framebufferTexture2D(s.FRAMEBUFFER,ne,Q,T.__webglTexture,re),t.bindFramebuffer(s.FRAMEBUFFER,null)}function an(w,v,O){if(s.bindRenderbuffer(s.RENDERBUFFER,w),v.depthBuffer){const ne=v.depthTexture,Q=ne&&ne.isDepthTexture?ne.type:null,re=_(v.stencilBuffer,Q),de=v.stencilBuffer?s.DEPTH_STENCIL_ATTACHMENT:s.DEPTH_ATTACHMENT;pe(v)?o.renderbufferStorageMultisampleEXT(s.RENDERBUFFER,rt(v),re,v.width,v.height):O?s.renderbufferStorageMultisample(s.RENDERBUFFER,rt(v),re,v.width,v.height):s.renderbufferStorage(s.RENDERBUFFER,re,v.width,v.height),s.framebufferRenderbuffer(s.FRAMEBUFFER,de,s.RENDERBUFFER,w)}else{const ne=v.textures;for(let Q=0;Q<ne.length;Q++){const re=ne[Q],de=r.convert(re.format,re.colorSpace),Y=r.convert(re.type),K=E(re.internalFormat,de,Y,re.normalized,re.colorSpace);pe(v)?o.renderbufferStorageMultisampleEXT(s.RENDERBUFFER,rt(v),K,v.width,v.height):O?s.renderbufferStorageMultisample(s.RENDERBUFFER,rt(v),K,v.width,v.height):s.renderbufferStorage(s.RENDERBUFFER,K,v.width,v.height)}}s.bindRenderbuffer(s.RENDERBUFFER,null)}function Mt(w,v,O){const ne=v.isWebGLCubeRenderTarget===!0;if(t.bindFramebuffer(s.FRAMEBUFFER,w),!(v.depthTexture&&v.depthTexture.isDepthTexture))throw new Error("THREE.WebGLTextures: renderTarget.depthTexture must be an instance of THREE.DepthTexture.");const Q=n.get(v.depthTexture);Q.__renderTarget=v;const re=ne?v.depthTexture.image[0]:v.depthTexture.image;(!Q.__webglTexture||re.width!==v.width||re.height!==v.height)&&(re.width=v.width,re.height=v.height,v.depthTexture.needsUpdate=!0),ne?fe(v.depthTexture,0):he(v.depthTexture,0);const de=Q.__webglTexture,Y=rt(v),K=ne?s.TEXTURE_CUBE_MAP_POSITIVE_X+O:s.TEXTURE_2D,oe=v.depthTexture.format===1027?s.DEPTH_STENCIL_ATTACHMENT:s.DEPTH_ATTACHMENT;if(v.depthTexture.format===1026)pe(v)?o.framebufferTexture2DMultisampleEXT(s.FRAMEBUFFER,oe,K,de,0,Y):s.framebufferTexture2D(s.FRAMEBUFFER,oe,K,de,0);else if(v.depthTexture.format===1027)pe(v)?o.framebufferTexture2DMultisampleEXT(s.FRAMEBUFFER,oe,K,de,0,Y):s.framebufferTexture2D(s.FRAMEBUFFER,oe,K,de,0);else throw new Error("THREE.WebGLTextures: Unknown depthTexture format.")}function Ht(w){const v=n.get(w),O=w.isWebGLCubeRenderTarget===!0;if(v.__boundDepthTexture!==w.depthTexture){const ne=w.depthTexture;if(v.__depthDisposeCallback&&v.__depthDisposeCallback(),ne){const Q=()=>{delete v.__boundDepthTexture,delete v.__depthDisposeCallback,ne.removeEventListener("dispose",Q)};ne.addEventListener("dispose",Q),v.__depthDisposeCallback=Q}v.__boundDepthTexture=ne}if(w.depthTexture&&!v.__autoAllocateDepthBuffer)if(O)for(let ne=0;ne<6;ne++)Mt(v.__webglFramebuffer[ne],w,ne);else w.texture.mipmaps.length>0?Mt(v.__webglFramebuffer[0],w,0):Mt(v.__webglFramebuffer,w,0);else if(O){v.__webglDepthbuffer=[];for(let ne=0;ne<6;ne++)if(t.bindFramebuffer(s.FRAMEBUFFER,v.__webglFramebuffer[ne]),v.__webglDepthbuffer[ne]===void 0)v.__webglDepthbuffer[ne]=s.createRenderbuffer(),an(v.__webglDepthbuffer[ne],w,!1);else{const Q=w.stencilBuffer?s.DEPTH_STENCIL_ATTACHMENT:s.DEPTH_ATTACHMENT,re=v.__webglDepthbuffer[ne];s.bindRenderbuffer(s.RENDERBUFFER,re),s.framebufferRenderbuffer(s.FRAMEBUFFER,Q,s.RENDERBUFFER,re)}}else if(w.texture.mipmaps.length>0?t.bindFramebuffer(s.FRAMEBUFFER,v.__webglFramebuffer[0]):t.bindFramebuffer(s.FRAMEBUFFER,v.__webglFramebuffer),v.__webglDepthbuffer===void 0)v.__webglDepthbuffer=s.createRenderbuffer(),an(v.__webglDepthbuffer,w,!1);else{const Q=w.stencilBuffer?s.DEPTH_STENCIL_ATTACHMENT:s.DEPTH_ATTACHMENT,re=v.__webglDepthbuffer;s.bindRenderbuffer(s.RENDERBUFFER,re),s.framebufferRenderbuffer(s.FRAMEBUFFER,Q,s.RENDERBUFFER,re)}t.bindFramebuffer(s.FRAMEBUFFER,null)}function Vt(w,v,O){const ne=n.get(w);v!==void 0&&ot(ne.__webglFramebuffer,w,w.texture,s.COLOR_ATTACHMENT0,s.TEXTURE_2D,0),O!==void 0&&Ht(w)}function Wt(w){const v=w.texture,O=n.get(w),ne=n.get(v);w.addEventListener("dispose",z),k(w);const Q=w.textures,re=w.isWebGLCubeRenderTarget===!0,de=Q.length>1;if(de||(ne.__webglTexture===void 0&&(ne.__webglTexture=s.createTexture()),ne.__version=v.version,a.memory.textures++),re){O.__webglFramebuffer=[];for(let Y=0;Y<6;Y++)if(v.mipmaps.length>0){O.__webglFramebuffer[Y]=[];for(let K=0;K<v.mipmaps.length;K++)O.__webglFramebuffer[Y][K]=s.createFramebuffer()}else O.__webglFramebuffer[Y]=s.createFramebuffer()}else{if(v.mipmaps.length>0){O.__webglFramebuffer=[];for(let Y=0;Y<v.mipmaps.length;Y++)O.__webglFramebuffer[Y]=s.createFramebuffer()}else O.__webglFramebuffer=s.createFramebuffer();if(de)for(let Y=0,K=Q.length;Y<K;Y++){const oe=n.get(Q[Y]);oe.__webglTexture===void 0&&(oe.__webglTexture=s.createTexture(),a.memory.textures++)}if(w.samples>0&&pe(w)===!1){O.__webglMultisampledFramebuffer=s.createFramebuffer(),O.__webglColorRenderbuffer=[],t.bindFramebuffer(s.FRAMEBUFFER,O.__webglMultisampledFramebuffer);for(let Y=0;Y<Q.length;Y++){const K=Q[Y];O.__webglColorRenderbuffer[Y]=s.createRenderbuffer(),s.bindRenderbuffer(s.RENDERBUFFER,O.__webglColorRenderbuffer[Y]);const oe=r.convert(K.format,K.colorSpace),T=r.convert(K.type),J=E(K.internalFormat,oe,T,K.normalized,K.colorSpace,w.isXRRenderTarget===!0),X=rt(w);s.renderbufferStorageMultisample(s.RENDERBUFFER,X,J,w.width,w.height),s.framebufferRenderbuffer(s.FRAMEBUFFER,s.COLOR_ATTACHMENT0+Y,s.RENDERBUFFER,O.__webglColorRenderbuffer[Y])}s.bindRenderbuffer(s.RENDERBUFFER,null),w.depthBuffer&&(O.__webglDepthRenderbuffer=s.createRenderbuffer(),an(O.__webglDepthRenderbuffer,w,!0)),t.bindFramebuffer(s.FRAMEBUFFER,null)}}if(re){t.bindTexture(s.TEXTURE_CUBE_MAP,ne.__webglTexture),He(s.TEXTURE_CUBE_MAP,v);for(let Y=0;Y<6;Y++)if(v.mipmaps.length>0)for(let K=0;K<v.mipmaps.length;K++)ot(O.__webglFramebuffer[Y][K],w,v,s.COLOR_ATTACHMENT0,s.TEXTURE_CUBE_MAP_POSITIVE_X+Y,K);else ot(O.__webglFramebuffer[Y],w,v,s.COLOR_ATTACHMENT0,s.TEXTURE_CUBE_MAP_POSITIVE_X+Y,0);A(v)?b(s.TEXTURE_CUBE_MAP):v.mipmaps.length>0&&s.texParameteri(s.TEXTURE_CUBE_MAP,s.TEXTURE_MAX_LEVEL,v.mipmaps.length-1),t.unbindTexture()}else if(de){for(let Y=0,K=Q.length;Y<K;Y++){const oe=Q[Y],T=n.get(oe);let J=s.TEXTURE_2D;(w.isWebGL3DRenderTarget||w.isWebGLArrayRenderTarget)&&(J=w.isWebGL3DRenderTarget?s.TEXTURE_3D:s.TEXTURE_2D_ARRAY),t.bindTexture(J,T.__webglTexture),He(J,oe),ot(O.__webglFramebuffer,w,oe,s.COLOR_ATTACHMENT0+Y,J,0),A(oe)&&b(J)}t.unbindTexture()}else{let Y=s.TEXTURE_2D;if((w.isWebGL3DRenderTarget||w.isWebGLArrayRenderTarget)&&(Y=w.isWebGL3DRenderTarget?s.TEXTURE_3D:s.TEXTURE_2D_ARRAY),t.bindTexture(Y,ne.__webglTexture),He(Y,v),v.mipmaps.length>0)for(let K=0;K<v.mipmaps.length;K++)ot(O.__webglFramebuffer[K],w,v,s.COLOR_ATTACHMENT0,Y,K);else ot(O.__webglFramebuffer,w,v,s.COLOR_ATTACHMENT0,Y,0);A(v)?b(Y):v.mipmaps.length>0&&s.texParameteri(Y,s.TEXTURE_MAX_LEVEL,v.mipmaps.length-1),t.unbindTexture()}w.depthBuffer&&Ht(w)}function F(w){const v=w.textures;for(let O=0,ne=v.length;O<ne;O++){const Q=v[O];if(A(Q)&&Q.mipmapsAutoUpdate===!0){const re=R(w),de=n.get(Q).__webglTexture;t.bindTexture(re,de),b(re),t.unbindTexture()}}}const Xt=[];function st(w){if(w.samples>0){if(pe(w)===!1){const v=w.textures,O=w.width,ne=w.height;let Q=s.COLOR_BUFFER_BIT;const re=w.stencilBuffer?s.DEPTH_STENCIL_ATTACHMENT:s.DEPTH_ATTACHMENT,de=n.get(w),Y=v.length>1;if(Y)for(let oe=0;oe<v.length;oe++)t.bindFramebuffer(s.FRAMEBUFFER,de.__webglMultisampledFramebuffer),s.framebufferRenderbuffer(s.FRAMEBUFFER,s.COLOR_ATTACHMENT0+oe,s.RENDERBUFFER,null),t.bindFramebuffer(s.FRAMEBUFFER,de.__webglFramebuffer),s.framebufferTexture2D(s.DRAW_FRAMEBUFFER,s.COLOR_ATTACHMENT0+oe,s.TEXTURE_2D,null,0);t.bindFramebuffer(s.READ_FRAMEBUFFER,de.__webglMultisampledFramebuffer),w.texture.mipmaps.length>0?t.bindFramebuffer(s.DRAW_FRAMEBUFFER,de.__webglFramebuffer[0]):t.bindFramebuffer(s.DRAW_FRAMEBUFFER,de.__webglFramebuffer);for(let oe=0;oe<v.length;oe++){if(w.resolveDepthBuffer&&(w.depthBuffer&&(Q|=s.DEPTH_BUFFER_BIT),w.stencilBuffer&&w.resolveStencilBuffer&&(Q|=s.STENCIL_BUFFER_BIT)),Y){s.framebufferRenderbuffer(s.READ_FRAMEBUFFER,s.COLOR_ATTACHMENT0,s.RENDERBUFFER,de.__webglColorRenderbuffer[oe]);const T=n.get(v[oe]).__webglTexture;s.framebufferTexture2D(s.DRAW_FRAMEBUFFER,s.COLOR_ATTACHMENT0,s.TEXTURE_2D,T,0)}s.blitFramebuffer(0,0,O,ne,0,0,O,ne,Q,s.NEAREST),l===!0&&(Xt.length=0,Xt.push(s.COLOR_ATTACHMENT0+oe),w.depthBuffer&&w.storeMultisampledDepthBuffer===!1&&Xt.push(re),s.invalidateFramebuffer(s.READ_FRAMEBUFFER,Xt))}if(t.bindFramebuffer(s.READ_FRAMEBUFFER,null),t.bindFramebuffer(s.DRAW_FRAMEBUFFER,null),Y)for(let oe=0;oe<v.length;oe++){t.bindFramebuffer(s.FRAMEBUFFER,de.__webglMultisampledFramebuffer),s.framebufferRenderbuffer(s.FRAMEBUFFER,s.COLOR_ATTACHMENT0+oe,s.RENDERBUFFER,de.__webglColorRenderbuffer[oe]);const T=n.get(v[oe]).__webglTexture;t.bindFramebuffer(s.FRAMEBUFFER,de.__webglFramebuffer),s.framebufferTexture2D(s.DRAW_FRAMEBUFFER,s.COLOR_ATTACHMENT0+oe,s.TEXTURE_2D,T,0)}t.bindFramebuffer(s.DRAW_FRAMEBUFFER,de.__webglMultisampledFramebuffer)}else if(w.depthBuffer&&w.storeMultisampledDepthBuffer===!1&&l){const v=w.stencilBuffer?s.DEPTH_STENCIL_ATTACHMENT:s.DEPTH_ATTACHMENT;s.invalidateFramebuffer(s.DRAW_FRAMEBUFFER,[v])}}}function rt(w){return Math.min(i.maxSamples,w.samples)}function pe(w){const v=n.get(w);return w.samples>0&&e.has("WEBGL_multisampled_render_to_texture")===!0&&v.__useRenderToTexture!==!1}function _t(w){const v=a.render.frame;h.get(w)!==v&&(h.set(w,v),w.update())}function Ce(w,v){const O=w.colorSpace,ne=w.format,Q=w.type;return w.isCompressedTexture===!0||w.isVideoTexture===!0||O!==Ls&&O!==""&&(qe.getTransfer(O)===tt?(ne!==1023||Q!==1009)&&Le("WebGLTextures: sRGB encoded textures have to use RGBAFormat and UnsignedByteType."):Je("WebGLTextures: Unsupported texture color space:",O)),v}function Fe(w){return typeof HTMLImageElement<"u"&&w instanceof HTMLImageElement?(c.width=w.naturalWidth||w.width,c.height=w.naturalHeight||w.height):typeof VideoFrame<"u"&&w instanceof VideoFrame?(c.width=w.displayWidth,c.height=w.displayHeight):(c.width=w.width,c.height=w.height),c}this.allocateTextureUnit=Pe,this.resetTextureUnits=j,this.getTextureUnits=ee,this.setTextureUnits=we,this.setTexture2D=he,this.setTexture2DArray=ve,this.setTexture3D=Ee,this.setTextureCube=fe,this.rebindTextures=Vt,this.setupRenderTarget=Wt,this.updateRenderTargetMipmap=F,this.updateMultisampleRenderTarget=st,this.setupDepthRenderbuffer=Ht,this.setupFrameBufferTexture=ot,this.useMultisampledRTT=pe,this.dispose=W}function Kf(s,e){function t(n,i=""){let r;const a=qe.getTransfer(i);if(n===1009)return s.UNSIGNED_BYTE;if(n===1017)return s.UNSIGNED_SHORT_4_4_4_4;if(n===1018)return s.UNSIGNED_SHORT_5_5_5_1;if(n===35902)return s.UNSIGNED_INT_5_9_9_9_REV;if(n===35899)return s.UNSIGNED_INT_10F_11F_11F_REV;if(n===1010)return s.BYTE;if(n===1011)return s.SHORT;if(n===1012)return s.UNSIGNED_SHORT;if(n===1013)return s.INT;if(n===1014)return s.UNSIGNED_INT;if(n===1015)return s.FLOAT;if(n===1016)return s.HALF_FLOAT;if(n===1021)return s.ALPHA;if(n===1022)return s.RGB;if(n===1023)return s.RGBA;if(n===1026)return s.DEPTH_COMPONENT;if(n===1027)return s.DEPTH_STENCIL;if(n===1028)return s.RED;if(n===1029)return s.RED_INTEGER;if(n===1030)return s.RG;if(n===1031)return s.RG_INTEGER;if(n===1033)return s.RGBA_INTEGER;if(n===33776||n===33777||n===33778||n===33779)if(a===tt)if(r=e.get("WEBGL_compressed_texture_s3tc_srgb"),r!==null){if(n===33776)return r.COMPRESSED_SRGB_S3TC_DXT1_EXT;if(n===33777)return r.COMPRESSED_SRGB_ALPHA_S3TC_DXT1_EXT;if(n===33778)return r.COMPRESSED_SRGB_ALPHA_S3TC_DXT3_EXT;if(n===33779)return r.COMPRESSED_SRGB_ALPHA_S3TC_DXT5_EXT}else return null;else if(r=e.get("WEBGL_compressed_texture_s3tc"),r!==null){if(n===33776)return r.COMPRESSED_RGB_S3TC_DXT1_EXT;if(n===33777)return r.COMPRESSED_RGBA_S3TC_DXT1_EXT;if(n===33778)return r.COMPRESSED_RGBA_S3TC_DXT3_EXT;if(n===33779)return r.COMPRESSED_RGBA_S3TC_DXT5_EXT}else return null;if(n===35840||n===35841||n===35842||n===35843)if(r=e.get("WEBGL_compressed_texture_pvrtc"),r!==null){if(n===35840)return r.COMPRESSED_RGB_PVRTC_4BPPV1_IMG;if(n===35841)return r.COMPRESSED_RGB_PVRTC_2BPPV1_IMG;if(n===35842)return r.COMPRESSED_RGBA_PVRTC_4BPPV1_IMG;if(n===35843)return r.COMPRESSED_RGBA_PVRTC_2BPPV1_IMG}else return null;if(n===36196||n===37492||n===37496||n===37488||n===37489||n===37490||n===37491)if(r=e.get("WEBGL_compressed_texture_etc"),r!==null){if(n===36196||n===37492)return a===tt?r.COMPRESSED_SRGB8_ETC2:r.COMPRESSED_RGB8_ETC2;if(n===37496)return a===tt?r.COMPRESSED_SRGB8_ALPHA8_ETC2_EAC:r.COMPRESSED_RGBA8_ETC2_EAC;if(n===37488)return r.COMPRESSED_R11_EAC;if(n===37489)return r.COMPRESSED_SIGNED_R11_EAC;if(n===37490)return r.COMPRESSED_RG11_EAC;if(n===37491)return r.COMPRESSED_SIGNED_RG11_EAC}else return null;if(n===37808||n===37809||n===37810||n===37811||n===37812||n===37813||n===37814||n===37815||n===37816||n===37817||n===37818||n===37819||n===37820||n===37821)if(r=e.get("WEBGL_compressed_texture_astc"),r!==null){if(n===37808)return a===tt?r.COMPRESSED_SRGB8_ALPHA8_ASTC_4x4_KHR:r.COMPRESSED_RGBA_ASTC_4x4_KHR;if(n===37809)return a===tt?r.COMPRESSED_SRGB8_ALPHA8_ASTC_5x4_KHR:r.COMPRESSED_RGBA_ASTC_5x4_KHR;if(n===37810)return a===tt?r.COMPRESSED_SRGB8_ALPHA8_ASTC_5x5_KHR:r.COMPRESSED_RGBA_ASTC_5x5_KHR;if(n===37811)return a===tt?r.COMPRESSED_SRGB8_ALPHA8_ASTC_6x5_KHR:r.COMPRESSED_RGBA_ASTC_6x5_KHR;if(n===37812)return a===tt?r.COMPRESSED_SRGB8_ALPHA8_ASTC_6x6_KHR:r.COMPRESSED_RGBA_ASTC_6x6_KHR;if(n===37813)return a===tt?r.COMPRESSED_SRGB8_ALPHA8_ASTC_8x5_KHR:r.COMPRESSED_RGBA_ASTC_8x5_KHR;if(n===37814)return a===tt?r.COMPRESSED_SRGB8_ALPHA8_ASTC_8x6_KHR:r.COMPRESSED_RGBA_ASTC_8x6_KHR;if(n===37815)return a===tt?r.COMPRESSED_SRGB8_ALPHA8_ASTC_8x8_KHR:r.COMPRESSED_RGBA_ASTC_8x8_KHR;if(n===37816)return a===tt?r.COMPRESSED_SRGB8_ALPHA8_ASTC_10x5_KHR:r.COMPRESSED_RGBA_ASTC_10x5_KHR;if(n===37817)return a===tt?r.COMPRESSED_SRGB8_ALPHA8_ASTC_10x6_KHR:r.COMPRESSED_RGBA_ASTC_10x6_KHR;if(n===37818)return a===tt?r.COMPRESSED_SRGB8_ALPHA8_ASTC_10x8_KHR:r.COMPRESSED_RGBA_ASTC_10x8_KHR;if(n===37819)return a===tt?r.COMPRESSED_SRGB8_ALPHA8_ASTC_10x10_KHR:r.COMPRESSED_RGBA_ASTC_10x10_KHR;if(n===37820)return a===tt?r.COMPRESSED_SRGB8_ALPHA8_ASTC_12x10_KHR:r.COMPRESSED_RGBA_ASTC_12x10_KHR;if(n===37821)return a===tt?r.COMPRESSED_SRGB8_ALPHA8_ASTC_12x12_KHR:r.COMPRESSED_RGBA_ASTC_12x12_KHR}else return null;if(n===36492||n===36494||n===36495)if(r=e.get("EXT_texture_compression_bptc"),r!==null){if(n===36492)return a===tt?r.COMPRESSED_SRGB_ALPHA_BPTC_UNORM_EXT:r.COMPRESSED_RGBA_BPTC_UNORM_EXT;if(n===36494)return r.COMPRESSED_RGB_BPTC_SIGNED_FLOAT_EXT;if(n===36495)return r.COMPRESSED_RGB_BPTC_UNSIGNED_FLOAT_EXT}else return null;if(n===36283||n===36284||n===36285||n===36286)if(r=e.get("EXT_texture_compression_rgtc"),r!==null){if(n===36283)return r.COMPRESSED_RED_RGTC1_EXT;if(n===36284)return r.COMPRESSED_SIGNED_RED_RGTC1_EXT;if(n===36285)return r.COMPRESSED_RED_GREEN_RGTC2_EXT;if(n===36286)return r.COMPRESSED_SIGNED_RED_GREEN_RGTC2_EXT}else return null;return n===1020?s.UNSIGNED_INT_24_8:s[n]!==void 0?s[n]:null}return{convert:t}}const Zf=`
void main() {

	gl_Position = vec4( position, 1.0 );

}`,Jf=`
uniform sampler2DArray depthColor;
uniform float depthWidth;
uniform float depthHeight;

void main() {

	vec2 coord = vec2( gl_FragCoord.x / depthWidth, gl_FragCoord.y / depthHeight );

	if ( coord.x >= 1.0 ) {

		gl_FragDepth = texture( depthColor, vec3( coord.x - 1.0, coord.y, 1 ) ).r;

	} else {

		gl_FragDepth = texture( depthColor, vec3( coord.x, coord.y, 0 ) ).r;

	}

}`;class Qf{constructor(){this.texture=null,this.mesh=null,this.depthNear=0,this.depthFar=0}init(e,t){if(this.texture===null){const n=new Io(e.texture);(e.depthNear!==t.depthNear||e.depthFar!==t.depthFar)&&(this.depthNear=e.depthNear,this.depthFar=e.depthFar),this.texture=n}}getMesh(e){if(this.texture!==null&&this.mesh===null){const t=e.cameras[0].viewport,n=new pn({vertexShader:Zf,fragmentShader:Jf,uniforms:{depthColor:{value:this.texture},depthWidth:{value:t.z},depthHeight:{value:t.w}}});this.mesh=new fn(new Ws(20,20),n)}return this.mesh}reset(){this.texture=null,this.mesh=null}getDepthTexture(){return this.texture}}class jf extends Jn{constructor(e,t){super();const n=this;let i=null,r=1,a=null,o="local-floor",l=1,c=null,h=null,u=null,d=null,f=null,g=null;const S=typeof XRWebGLBinding<"u",m=new Qf,p={},M=t.getContextAttributes();let A=null,b=null;const R=[],E=[],_=new Ye;let y=null,k=null;const N=new sn;N.viewport=new gt;const I=new sn;I.viewport=new gt;const z=[N,I],$=new cc;let P=null,W=null;this.cameraAutoUpdate=!0,this.enabled=!1,this.isPresenting=!1,this.getController=function(q){let he=R[q];return he===void 0&&(he=new rr,R[q]=he),he.getTargetRaySpace()},this.getControllerGrip=function(q){let he=R[q];return he===void 0&&(he=new rr,R[q]=he),he.getGripSpace()},this.getHand=function(q){let he=R[q];return he===void 0&&(he=new rr,R[q]=he),he.getHandSpace()};function Z(q){const he=E.indexOf(q.inputSource);if(he===-1)return;const ve=R[he];ve!==void 0&&(ve.update(q.inputSource,q.frame,c||a),ve.dispatchEvent({type:q.type,data:q.inputSource}))}function H(){i.removeEventListener("select",Z),i.removeEventListener("selectstart",Z),i.removeEventListener("selectend",Z),i.removeEventListener("squeeze",Z),i.removeEventListener("squeezestart",Z),i.removeEventListener("squeezeend",Z),i.removeEventListener("end",H),i.removeEventListener("inputsourceschange",te);for(let q=0;q<R.length;q++){const he=E[q];he!==null&&(E[q]=null,R[q].disconnect(he))}P=null,W=null,m.reset();for(const q in p)delete p[q];if(e.setRenderTarget(A),f=null,d=null,u=null,i=null,b=null,Pe.stop(),n.isPresenting=!1,e.setPixelRatio(y),e.setSize(_.width,_.height,!1),k!==null){const q=k.camera;q.fov=k.fov,q.zoom=k.zoom,q.updateProjectionMatrix(),k=null}n.dispatchEvent({type:"sessionend"})}this.setFramebufferScaleFactor=function(q){r=q,n.isPresenting===!0&&Le("WebXRManager: Cannot change framebuffer scale while presenting.")},this.setReferenceSpaceType=function(q){o=q,n.isPresenting===!0&&Le("WebXRManager: Cannot change reference space type while presenting.")},this.getReferenceSpace=function(){return c||a},this.setReferenceSpace=function(q){c=q},this.getBaseLayer=function(){return d!==null?d:f},this.getBinding=function(){return u===null&&S&&(u=new XRWebGLBinding(i,t)),u},this.getFrame=function(){return g},this.getSession=function(){return i},this.setSession=async function(q){if(i=q,i!==null){if(A=e.getRenderTarget(),i.addEventListener("select",Z),i.addEventListener("selectstart",Z),i.addEventListener("selectend",Z),i.addEventListener("squeeze",Z),i.addEventListener("squeezestart",Z),i.addEventListener("squeezeend",Z),i.addEventListener("end",H),i.addEventListener("inputsourceschange",te),M.xrCompatible!==!0&&await t.makeXRCompatible(),y=e.getPixelRatio(),e.getSize(_),S&&"createProjectionLayer"in XRWebGLBinding.prototype){let ve=null,Ee=null,fe=null;M.depth&&(fe=M.stencil?t.DEPTH24_STENCIL8:t.DEPTH_COMPONENT24,ve=M.stencil?1027:1026,Ee=M.stencil?1020:1014);const De={colorFormat:t.RGBA8,depthFormat:fe,scaleFactor:r};u=this.getBinding(),d=u.createProjectionLayer(De),i.updateRenderState({layers:[d]}),e.setPixelRatio(1),e.setSize(d.textureWidth,d.textureHeight,!1),b=new Zt(d.textureWidth,d.textureHeight,{format:1023,type:1009,depthTexture:new Zn(d.textureWidth,d.textureHeight,Ee,void 0,void 0,void 0,void 0,void 0,void 0,ve),stencilBuffer:M.stencil,colorSpace:e.outputColorSpace,samples:M.antialias?4:0,resolveDepthBuffer:d.ignoreDepthValues===!1,resolveStencilBuffer:d.ignoreDepthValues===!1,storeMultisampledDepthBuffer:d.ignoreDepthValues===!1,storeMultisampledStencilBuffer:d.ignoreDepthValues===!1})}else{const ve={antialias:M.antialias,alpha:!0,depth:M.depth,stencil:M.stencil,framebufferScaleFactor:r};f=new XRWebGLLayer(i,t,ve),i.updateRenderState({baseLayer:f}),e.setPixelRatio(1),e.setSize(f.framebufferWidth,f.framebufferHeight,!1),b=new Zt(f.framebufferWidth,f.framebufferHeight,{format:1023,type:1009,colorSpace:e.outputColorSpace,stencilBuffer:M.stencil,resolveDepthBuffer:f.ignoreDepthValues===!1,resolveStencilBuffer:f.ignoreDepthValues===!1,storeMultisampledDepthBuffer:f.ignoreDepthValues===!1,storeMultisampledStencilBuffer:f.ignoreDepthValues===!1})}b.isXRRenderTarget=!0,this.setFoveation(l),c=null,a=await i.requestReferenceSpace(o),Pe.setContext(i),Pe.start(),n.isPresenting=!0,n.dispatchEvent({type:"sessionstart"})}},this.getEnvironmentBlendMode=function(){if(i!==null)return i.environmentBlendMode},this.getDepthTexture=function(){return m.getDepthTexture()};function te(q){for(let he=0;he<q.removed.length;he++){const ve=q.removed[he],Ee=E.indexOf(ve);Ee>=0&&(E[Ee]=null,R[Ee].disconnect(ve))}for(let he=0;he<q.added.length;he++){const ve=q.added[he];let Ee=E.indexOf(ve);if(Ee===-1){for(let De=0;De<R.length;De++)if(De>=E.length){E.push(ve),Ee=De;break}else if(E[De]===null){E[De]=ve,Ee=De;break}if(Ee===-1)break}const fe=R[Ee];fe&&fe.connect(ve)}}function V(q,he){he===null?q.matrixWorld.copy(q.matrix):q.matrixWorld.multiplyMatrices(he.matrixWorld,q.matrix),q.matrixWorldInverse.copy(q.matrixWorld).invert()}this.updateCamera=function(q){if(i===null)return;let he=q.near,ve=q.far;m.texture!==null&&(m.depthNear>0&&(he=m.depthNear),m.depthFar>0&&(ve=m.depthFar)),$.near=I.near=N.near=he,$.far=I.far=N.far=ve,(P!==$.near||W!==$.far)&&(i.updateRenderState({depthNear:$.near,depthFar:$.far}),P=$.near,W=$.far),$.layers.mask=q.layers.mask|6,N.layers.mask=$.layers.mask&-5,I.layers.mask=$.layers.mask&-3;const Ee=q.parent,fe=$.cameras;V($,Ee);for(let De=0;De<fe.length;De++)V(fe[De],Ee);$.projectionMatrix.copy(N.projectionMatrix),$.projectionMatrixInverse.copy(N.projectionMatrixInverse),k===null&&q.isPerspectiveCamera&&(k={camera:q,fov:q.fov,zoom:q.zoom}),j(q,$,Ee)};function j(q,he,ve){ve===null?q.matrix.copy(he.matrixWorld):(q.matrix.copy(ve.matrixWorld),q.matrix.invert(),q.matrix.multiply(he.matrixWorld)),q.matrix.decompose(q.position,q.quaternion,q.scale),q.updateMatrixWorld(!0),q.projectionMatrix.copy(he.projectionMatrix),q.projectionMatrixInverse.copy(he.projectionMatrixInverse),q.isPerspectiveCamera&&(q.fov=Pr*2*Math.atan(1/q.projectionMatrix.elements[5]),q.zoom=1)}this.getCamera=function(){return $},this.getFoveation=function(){if(!(d===null&&f===null))return l},this.setFoveation=function(q){l=q,d!==null&&(d.fixedFoveation=q),f!==null&&f.fixedFoveation!==void 0&&(f.fixedFoveation=q)},this.hasDepthSensing=function(){return m.texture!==null},this.getDepthSensingMesh=function(){return m.getMesh($)},this.getCameraTexture=function(q){return p[q]};let ee=null;function we(q,he){if(h=he.getViewerPose(c||a),g=he,h!==null){const ve=h.views;f!==null&&(e.setRenderTargetFramebuffer(b,f.framebuffer),e.setRenderTarget(b));let Ee=!1;ve.length!==$.cameras.length&&($.cameras.length=0,Ee=!0);for(let Te=0;Te<ve.length;Te++){const He=ve[Te];let Ne=null;if(f!==null)Ne=f.getViewport(He);else{const dt=u.getViewSubImage(d,He);Ne=dt.viewport,Te===0&&(e.setRenderTargetTextures(b,dt.colorTexture,dt.depthStencilTexture),e.setRenderTarget(b))}let Be=z[Te];Be===void 0&&(Be=new sn,Be.layers.enable(Te),Be.viewport=new gt,z[Te]=Be),Be.matrix.fromArray(He.transform.matrix),Be.matrix.decompose(Be.position,Be.quaternion,Be.scale),Be.projectionMatrix.fromArray(He.projectionMatrix),Be.projectionMatrixInverse.copy(Be.projectionMatrix).invert(),Be.viewport.set(Ne.x,Ne.y,Ne.width,Ne.height),Te===0&&($.matrix.copy(Be.matrix),$.matrix.decompose($.position,$.quaternion,$.scale)),Ee===!0&&$.cameras.push(Be)}const fe=i.enabledFeatures;if(fe&&fe.includes("depth-sensing")&&i.depthUsage=="gpu-optimized"&&S){u=n.getBinding();const Te=u.getDepthInformation(ve[0]);Te&&Te.isValid&&Te.texture&&m.init(Te,i.renderState)}if(fe&&fe.includes("camera-access")&&S){e.state.unbindTexture(),u=n.getBinding();for(let Te=0;Te<ve.length;Te++){const He=ve[Te].camera;if(He){let Ne=p[He];Ne||(Ne=new Io,p[He]=Ne);const Be=u.getCameraImage(He);Ne.sourceTexture=Be}}}}for(let ve=0;ve<R.length;ve++){const Ee=E[ve],fe=R[ve];Ee!==null&&fe!==void 0&&fe.update(Ee,he,c||a)}ee&&ee(q,he),he.detectedPlanes&&n.dispatchEvent({type:"planesdetected",data:he}),g=null}const Pe=new zo;Pe.setAnimationLoop(we),this.setAnimationLoop=function(q){ee=q},this.dispose=function(){}}}const ep=new Qe,Jo=new Ue;Jo.set(-1,0,0,0,1,0,0,0,1);function tp(s,e){function t(m,p){m.matrixAutoUpdate===!0&&m.updateMatrix(),p.value.copy(m.matrix)}function n(m,p){p.color.getRGB(m.fogColor.value,Uo(s)),p.isFog?(m.fogNear.value=p.near,m.fogFar.value=p.far):p.isFogExp2&&(m.fogDensity.value=p.density)}function i(m,p,M,A,b){p.isNodeMaterial?p.uniformsNeedUpdate=!1:p.isMeshBasicMaterial?r(m,p):p.isMeshLambertMaterial?(r(m,p),p.envMap&&(m.envMapIntensity.value=p.envMapIntensity)):p.isMeshToonMaterial?(r(m,p),u(m,p)):p.isMeshPhongMaterial?(r(m,p),h(m,p),p.envMap&&(m.envMapIntensity.value=p.envMapIntensity)):p.isMeshStandardMaterial?(r(m,p),d(m,p),p.isMeshPhysicalMaterial&&f(m,p,b)):p.isMeshMatcapMaterial?(r(m,p),g(m,p)):p.isMeshDepthMaterial?r(m,p):p.isMeshDistanceMaterial?(r(m,p),S(m,p)):p.isMeshNormalMaterial?r(m,p):p.isLineBasicMaterial?(a(m,p),p.isLineDashedMaterial&&o(m,p)):p.isPointsMaterial?l(m,p,M,A):p.isSpriteMaterial?c(m,p):p.isShadowMaterial?(m.color.value.copy(p.color),m.opacity.value=p.opacity):p.isShaderMaterial&&(p.uniformsNeedUpdate=!1)}function r(m,p){m.opacity.value=p.opacity,p.color&&m.diffuse.value.copy(p.color),p.emissive&&m.emissive.value.copy(p.emissive).multiplyScalar(p.emissiveIntensity),p.map&&(m.map.value=p.map,t(p.map,m.mapTransform)),p.alphaMap&&(m.alphaMap.value=p.alphaMap,t(p.alphaMap,m.alphaMapTransform)),p.bumpMap&&(m.bumpMap.value=p.bumpMap,t(p.bumpMap,m.bumpMapTransform),m.bumpScale.value=p.bumpScale,p.side===1&&(m.bumpScale.value*=-1)),p.normalMap&&(m.normalMap.value=p.normalMap,t(p.normalMap,m.normalMapTransform),m.normalScale.value.copy(p.normalScale),p.side===1&&m.normalScale.value.negate()),p.displacementMap&&(m.displacementMap.value=p.displacementMap,t(p.displacementMap,m.displacementMapTransform),m.displacementScale.value=p.displacementScale,m.displacementBias.value=p.displacementBias),p.emissiveMap&&(m.emissiveMap.value=p.emissiveMap,t(p.emissiveMap,m.emissiveMapTransform)),p.specularMap&&(m.specularMap.value=p.specularMap,t(p.specularMap,m.specularMapTransform)),p.alphaTest>0&&(m.alphaTest.value=p.alphaTest);const M=e.get(p),A=M.envMap,b=M.envMapRotation;A&&(m.envMap.value=A,m.envMapRotation.value.setFromMatrix4(ep.makeRotationFromEuler(b)).transpose(),A.isCubeTexture&&A.isRenderTargetTexture===!1&&m.envMapRotation.value.premultiply(Jo),m.reflectivity.value=p.reflectivity,m.ior.value=p.ior,m.refractionRatio.value=p.refractionRatio),p.lightMap&&(m.lightMap.value=p.lightMap,m.lightMapIntensity.value=p.lightMapIntensity,t(p.lightMap,m.lightMapTransform)),p.aoMap&&(m.aoMap.value=p.aoMap,m.aoMapIntensity.value=p.aoMapIntensity,t(p.aoMap,m.aoMapTransform))}function a(m,p){m.diffuse.value.copy(p.color),m.opacity.value=p.opacity,p.map&&(m.map.value=p.map,t(p.map,m.mapTransform))}function o(m,p){m.dashSize.value=p.dashSize,m.totalSize.value=p.dashSize+p.gapSize,m.scale.value=p.scale}function l(m,p,M,A){m.diffuse.value.copy(p.color),m.opacity.value=p.opacity,m.size.value=p.size*M,m.scale.value=A*.5,p.map&&(m.map.value=p.map,t(p.map,m.uvTransform)),p.alphaMap&&(m.alphaMap.value=p.alphaMap,t(p.alphaMap,m.alphaMapTransform)),p.alphaTest>0&&(m.alphaTest.value=p.alphaTest)}function c(m,p){m.diffuse.value.copy(p.color),m.opacity.value=p.opacity,m.rotation.value=p.rotation,p.map&&(m.map.value=p.map,t(p.map,m.mapTransform)),p.alphaMap&&(m.alphaMap.value=p.alphaMap,t(p.alphaMap,m.alphaMapTransform)),p.alphaTest>0&&(m.alphaTest.value=p.alphaTest)}function h(m,p){m.specular.value.copy(p.specular),m.shininess.value=Math.max(p.shininess,1e-4)}function u(m,p){p.gradientMap&&(m.gradientMap.value=p.gradientMap)}function d(m,p){m.metalness.value=p.metalness,p.metalnessMap&&(m.metalnessMap.value=p.metalnessMap,t(p.metalnessMap,m.metalnessMapTransform)),m.roughness.value=p.roughness,p.roughnessMap&&(m.roughnessMap.value=p.roughnessMap,t(p.roughnessMap,m.roughnessMapTransform)),p.envMap&&(m.envMapIntensity.value=p.envMapIntensity)}function f(m,p,M){m.ior.value=p.ior,p.diffuseRoughness>0&&(m.diffuseRoughness.value=p.diffuseRoughness,p.diffuseRoughnessMap&&(m.diffuseRoughnessMap.value=p.diffuseRoughnessMap,t(p.diffuseRoughnessMap,m.diffuseRoughnessMapTransform))),p.sheen>0&&(m.sheenColor.value.copy(p.sheenColor).multiplyScalar(p.sheen),m.sheenRoughness.value=p.sheenRoughness,p.sheenColorMap&&(m.sheenColorMap.value=p.sheenColorMap,t(p.sheenColorMap,m.sheenColorMapTransform)),p.sheenRoughnessMap&&(m.sheenRoughnessMap.value=p.sheenRoughnessMap,t(p.sheenRoughnessMap,m.sheenRoughnessMapTransform))),p.clearcoat>0&&(m.clearcoat.value=p.clearcoat,m.clearcoatRoughness.value=p.clearcoatRoughness,p.clearcoatMap&&(m.clearcoatMap.value=p.clearcoatMap,t(p.clearcoatMap,m.clearcoatMapTransform)),p.clearcoatRoughnessMap&&(m.clearcoatRoughnessMap.value=p.clearcoatRoughnessMap,t(p.clearcoatRoughnessMap,m.clearcoatRoughnessMapTransform)),p.clearcoatNormalMap&&(m.clearcoatNormalMap.value=p.clearcoatNormalMap,t(p.clearcoatNormalMap,m.clearcoatNormalMapTransform),m.clearcoatNormalScale.value.copy(p.clearcoatNormalScale),p.side===1&&m.clearcoatNormalScale.value.negate())),p.dispersion>0&&(m.dispersion.value=p.dispersion),p.retroreflectivity>0&&(m.retroreflectivity.value=p.retroreflectivity),p.iridescence>0&&(m.iridescence.value=p.iridescence,m.iridescenceIOR.value=p.iridescenceIOR,m.iridescenceThicknessMinimum.value=p.iridescenceThicknessMinimum,m.iridescenceThicknessMaximum.value=p.iridescenceThicknessMaximum,p.iridescenceMap&&(m.iridescenceMap.value=p.iridescenceMap,t(p.iridescenceMap,m.iridescenceMapTransform)),p.iridescenceThicknessMap&&(m.iridescenceThicknessMap.value=p.iridescenceThicknessMap,t(p.iridescenceThicknessMap,m.iridescenceThicknessMapTransform))),p.transmission>0&&(m.transmission.value=p.transmission,m.transmissionSamplerMap.value=M.texture,m.transmissionSamplerSize.value.set(M.width,M.height),p.transmissionMap&&(m.transmissionMap.value=p.transmissionMap,t(p.transmissionMap,m.transmissionMapTransform)),m.thickness.value=p.thickness,p.thicknessMap&&(m.thicknessMap.value=p.thicknessMap,t(p.thicknessMap,m.thicknessMapTransform)),m.attenuationDistance.value=p.attenuationDistance,m.attenuationColor.value.copy(p.attenuationColor)),p.anisotropy>0&&(m.anisotropyVector.value.set(p.anisotropy*Math.cos(p.anisotropyRotation),p.anisotropy*Math.sin(p.anisotropyRotation)),p.anisotropyMap&&(m.anisotropyMap.value=p.anisotropyMap,t(p.anisotropyMap,m.anisotropyMapTransform))),m.specularIntensity.value=p.specularIntensity,m.specularColor.value.copy(p.specularColor),p.specularColorMap&&(m.specularColorMap.value=p.specularColorMap,t(p.specularColorMap,m.specularColorMapTransform)),p.specularIntensityMap&&(m.specularIntensityMap.value=p.specularIntensityMap,t(p.specularIntensityMap,m.specularIntensityMapTransform))}function g(m,p){p.matcap&&(m.matcap.value=p.matcap)}function S(m,p){const M=e.get(p).light;m.referencePosition.value.setFromMatrixPosition(M.matrixWorld),m.nearDistance.value=M.shadow.camera.near,m.farDistance.value=M.shadow.camera.far}return{refreshFogUniforms:n,refreshMaterialUniforms:i}}function np(s,e,t,n){let i={},r={};function a(M,A){const b=A.program;n.uniformBlockBinding(M,b,i[M.id])}function o(M,A){let b=i[M.id];b===void 0&&(g(M),b=l(M),i[M.id]=b,M.addEventListener("dispose",m));const R=A.program;n.updateUBOMapping(M,R);const E=e.render.frame;r[M.id]!==E&&(c(M),r[M.id]=E)}function l(M){const A=s.createBuffer(),b=M.__size,R=M.usage;return s.bindBuffer(s.UNIFORM_BUFFER,A),s.bufferData(s.UNIFORM_BUFFER,b,R),s.bindBuffer(s.UNIFORM_BUFFER,null),A}function c(M){const A=i[M.id],b=M.uniforms,R=M.__cache;s.bindBuffer(s.UNIFORM_BUFFER,A);for(let E=0,_=b.length;E<_;E++){const y=b[E];if(Array.isArray(y))for(let k=0,N=y.length;k<N;k++)h(y[k],E,k,R);else h(y,E,0,R)}s.bindBuffer(s.UNIFORM_BUFFER,null)}function h(M,A,b,R){if(d(M,A,b,R)===!0){const E=M.__offset,_=M.value;if(Array.isArray(_)){let y=0;for(let k=0;k<_.length;k++){const N=_[k],I=S(N,!0);u(N,M.__data,y),y+=I.storage/Float32Array.BYTES_PER_ELEMENT}}else u(_,M.__data,0);s.bufferSubData(s.UNIFORM_BUFFER,E,M.__data)}}function u(M,A,b){typeof M=="number"||typeof M=="boolean"?A[b]=M:M.isMatrix3?(A[b]=M.elements[0],A[b+1]=M.elements[1],A[b+2]=M.elements[2],A[b+3]=0,A[b+4]=M.elements[3],A[b+5]=M.elements[4],A[b+6]=M.elements[5],A[b+7]=0,A[b+8]=M.elements[6],A[b+9]=M.elements[7],A[b+10]=M.elements[8],A[b+11]=0):ArrayBuffer.isView(M)?A.set(M.subarray(0,A.length-b),b):M.toArray(A,b)}function d(M,A,b,R){const E=M.value,_=A+"_"+b;if(Array.isArray(E)){R[_]===void 0&&(R[_]=[]);const y=R[_];let k=!1;for(let N=0;N<E.length;N++)f(E[N],y,N)===!0&&(k=!0);return k}return f(E,R,_)}function f(M,A,b){if(A[b]===void 0)return typeof M=="number"||typeof M=="boolean"?A[b]=M:ArrayBuffer.isView(M)?A[b]=M.slice():A[b]=M.clone(),!0;{const R=A[b];if(typeof M=="number"||typeof M=="boolean"){if(R!==M)return A[b]=M,!0}else{if(ArrayBuffer.isView(M))return!0;if(R.equals(M)===!1)return R.copy(M),!0}}return!1}function g(M){const A=M.uniforms;let b=0;const R=16;for(let _=0,y=A.length;_<y;_++){const k=Array.isArray(A[_])?A[_]:[A[_]];for(let N=0,I=k.length;N<I;N++){const z=k[N],$=Array.isArray(z.value)?z.value:[z.value],P=Array.isArray(A[_])||Array.isArray(z.value);let W=b;for(let H=0,te=$.length;H<te;H++){const V=$[H],j=S(V,P),ee=b%R,we=ee%j.boundary,Pe=ee+we;b+=we,Pe!==0&&R-Pe<j.storage&&(b+=R-Pe),H===0&&(W=b),b+=j.storage}const Z=z.type==="int"?Int32Array:z.type==="uint"?Uint32Array:Float32Array;z.__data=new Z((b-W)/Float32Array.BYTES_PER_ELEMENT),z.__offset=W}}const E=b%R;return E>0&&(b+=R-E),M.__size=b,M.__cache={},this}function S(M,A){const b={boundary:0,storage:0};return typeof M=="number"||typeof M=="boolean"?(b.boundary=4,b.storage=4):M.isVector2?(b.boundary=8,b.storage=8):M.isVector3||M.isColor?(b.boundary=16,b.storage=12):M.isVector4?(b.boundary=16,b.storage=16):M.isMatrix3?(b.boundary=16,b.storage=48):M.isMatrix4?(b.boundary=16,b.storage=64):M.isTexture?Le("WebGLRenderer: Texture samplers can not be part of an uniforms group."):ArrayBuffer.isView(M)?(b.boundary=16,b.storage=M.byteLength):Le("WebGLRenderer: Unsupported uniform value type.",M),A===!0&&(b.boundary=16,b.storage=Math.ceil(b.storage/16)*16),b}function m(M){const A=M.target;A.removeEventListener("dispose",m),s.deleteBuffer(i[A.id]),delete i[A.id],delete r[A.id]}function p(){for(const M in i)s.deleteBuffer(i[M]);i={},r={}}return{bind:a,update:o,dispose:p}}const ip=new Uint16Array([12469,15057,12620,14925,13266,14620,13807,14376,14323,13990,14545,13625,14713,13328,14840,12882,14931,12528,14996,12233,15039,11829,15066,11525,15080,11295,15085,10976,15082,10705,15073,10495,13880,14564,13898,14542,13977,14430,14158,14124,14393,13732,14556,13410,14702,12996,14814,12596,14891,12291,14937,11834,14957,11489,14958,11194,14943,10803,14921,10506,14893,10278,14858,9960,14484,14039,14487,14025,14499,13941,14524,13740,14574,13468,14654,13106,14743,12678,14818,12344,14867,11893,14889,11509,14893,11180,14881,10751,14852,10428,14812,10128,14765,9754,14712,9466,14764,13480,14764,13475,14766,13440,14766,13347,14769,13070,14786,12713,14816,12387,14844,11957,14860,11549,14868,11215,14855,10751,14825,10403,14782,10044,14729,9651,14666,9352,14599,9029,14967,12835,14966,12831,14963,12804,14954,12723,14936,12564,14917,12347,14900,11958,14886,11569,14878,11247,14859,10765,14828,10401,14784,10011,14727,9600,14660,9289,14586,8893,14508,8533,15111,12234,15110,12234,15104,12216,15092,12156,15067,12010,15028,11776,14981,11500,14942,11205,14902,10752,14861,10393,14812,9991,14752,9570,14682,9252,14603,8808,14519,8445,14431,8145,15209,11449,15208,11451,15202,11451,15190,11438,15163,11384,15117,11274,15055,10979,14994,10648,14932,10343,14871,9936,14803,9532,14729,9218,14645,8742,14556,8381,14461,8020,14365,7603,15273,10603,15272,10607,15267,10619,15256,10631,15231,10614,15182,10535,15118,10389,15042,10167,14963,9787,14883,9447,14800,9115,14710,8665,14615,8318,14514,7911,14411,7507,14279,7198,15314,9675,15313,9683,15309,9712,15298,9759,15277,9797,15229,9773,15166,9668,15084,9487,14995,9274,14898,8910,14800,8539,14697,8234,14590,7790,14479,7409,14367,7067,14178,6621,15337,8619,15337,8631,15333,8677,15325,8769,15305,8871,15264,8940,15202,8909,15119,8775,15022,8565,14916,8328,14804,8009,14688,7614,14569,7287,14448,6888,14321,6483,14088,6171,15350,7402,15350,7419,15347,7480,15340,7613,15322,7804,15287,7973,15229,8057,15148,8012,15046,7846,14933,7611,14810,7357,14682,7069,14552,6656,14421,6316,14251,5948,14007,5528,15356,5942,15356,5977,15353,6119,15348,6294,15332,6551,15302,6824,15249,7044,15171,7122,15070,7050,14949,6861,14818,6611,14679,6349,14538,6067,14398,5651,14189,5311,13935,4958,15359,4123,15359,4153,15356,4296,15353,4646,15338,5160,15311,5508,15263,5829,15188,6042,15088,6094,14966,6001,14826,5796,14678,5543,14527,5287,14377,4985,14133,4586,13869,4257,15360,1563,15360,1642,15358,2076,15354,2636,15341,3350,15317,4019,15273,4429,15203,4732,15105,4911,14981,4932,14836,4818,14679,4621,14517,4386,14359,4156,14083,3795,13808,3437,15360,122,15360,137,15358,285,15355,636,15344,1274,15322,2177,15281,2765,15215,3223,15120,3451,14995,3569,14846,3567,14681,3466,14511,3305,14344,3121,14037,2800,13753,2467,15360,0,15360,1,15359,21,15355,89,15346,253,15325,479,15287,796,15225,1148,15133,1492,15008,1749,14856,1882,14685,1886,14506,1783,14324,1608,13996,1398,13702,1183]);let ln=null;function sp(){return ln===null&&(ln=new Bi(ip,16,16,1030,1016),ln.name="DFG_LUT",ln.minFilter=1006,ln.magFilter=1006,ln.wrapS=1001,ln.wrapT=1001,ln.generateMipmaps=!1,ln.needsUpdate=!0),ln}class rp{constructor(e={}){const{canvas:t=El(),context:n=null,depth:i=!0,stencil:r=!1,alpha:a=!1,antialias:o=!1,premultipliedAlpha:l=!0,preserveDrawingBuffer:c=!1,powerPreference:h="default",failIfMajorPerformanceCaveat:u=!1,reversedDepthBuffer:d=!1,outputBufferType:f=1009}=e;this.isWebGLRenderer=!0;let g;if(n!==null){if(typeof WebGLRenderingContext<"u"&&n instanceof WebGLRenderingContext)throw new Error("THREE.WebGLRenderer: WebGL 1 is not supported since r163.");g=n.getContextAttributes().alpha}else g=a;const S=f,m=new Set([1033,1031,1029]),p=new Set([1009,1014,1012,1020,1017,1018]),M=new Uint32Array(4),A=new Int32Array(4),b={textures:[],min:[],max:[],resolution:[]};let R=null,E=null;const _=[],y=[];let k=null;this.domElement=t,this.debug={checkShaderErrors:!0,diagnostics:{keywords:!1},onShaderError:null},this.autoClear=!0,this.autoClearColor=!0,this.autoClearDepth=!0,this.autoClearStencil=!0,this.sortObjects=!0,this.clippingPlanes=[],this.localClippingEnabled=!1,this.toneMapping=0,this.toneMappingExposure=1,this.transmissionResolutionScale=1;const N=this;let I=!1,z=null,$=null,P=null,W=null;this._outputColorSpace=qt;let Z=0,H=0,te=null,V=-1,j=null;const ee=new gt,we=new gt;let Pe=null;const q=new Xe(0);let he=0,ve=t.width,Ee=t.height,fe=1,De=null,Ke=null;const Te=new gt(0,0,ve,Ee),He=new gt(0,0,ve,Ee);let Ne=!1;const Be=new Kn,dt=new Vr;let at=!1,Ut=!1;const ot=new Qe,an=new D,Mt=new gt,Ht={background:null,fog:null,environment:null,overrideMaterial:null,isScene:!0};let Vt=!1;function Wt(){return te===null?fe:1}let F=n;function Xt(x,C){return t.getContext(x,C)}let st,rt,pe,_t,Ce,Fe,w,v,O,ne,Q,re,de,Y,K,oe,T,J,X,le,se,ae,be;try{const x={alpha:!0,depth:i,stencil:r,antialias:o,premultipliedAlpha:l,preserveDrawingBuffer:c,powerPreference:h,failIfMajorPerformanceCaveat:u};if("setAttribute"in t&&t.setAttribute("data-engine","three.js r187"),t.addEventListener("webglcontextlost",Re,!1),t.addEventListener("webglcontextrestored",Oe,!1),t.addEventListener("webglcontextcreationerror",me,!1),F===null){const C="webgl2";if(F=Xt(C,x),F===null)throw Xt(C)?new Error("THREE.WebGLRenderer: Error creating WebGL context with your selected attributes."):new Error("THREE.WebGLRenderer: Error creating WebGL context.")}ke()}catch(x){throw t.removeEventListener("webglcontextlost",Re,!1),t.removeEventListener("webglcontextrestored",Oe,!1),t.removeEventListener("webglcontextcreationerror",me,!1),Je("WebGLRenderer: "+x.message),x}function ke(){st=new ou(F),st.init(),se=new Kf(F,st),rt=new Zd(F,st,e,se),pe=new qf(F,st),rt.reversedDepthBuffer&&d&&pe.buffers.depth.setReversed(!0),$=F.createFramebuffer(),P=F.createFramebuffer(),W=F.createFramebuffer(),_t=new hu(F),Ce=new Nf,Fe=new Yf(F,st,pe,Ce,rt,se,_t),w=new au(N),v=new uc(F),ae=new Yd(F,v),O=new lu(F,v,_t,ae),ne=new uu(F,O,v,ae,_t),J=new du(F,rt,Fe),K=new Jd(Ce),Q=new Df(N,w,st,rt,ae,K),re=new tp(N,Ce),de=new If,Y=new zf(st),T=new qd(N,w,pe,ne,g,l),oe=new $f(N,ne,rt),be=new np(F,_t,rt,pe),X=new Kd(F,st,_t),le=new cu(F,st,_t),_t.programs=Q.programs,N.capabilities=rt,N.extensions=st,N.properties=Ce,N.renderLists=de,N.shadowMap=oe,N.state=pe,N.info=_t}S!==1009&&(k=new pu(S,t.width,t.height,o,i,r));const ie=new jf(N,F);this.xr=ie,this.getContext=function(){return F},this.getContextAttributes=function(){return F.getContextAttributes()},this.forceContextLoss=function(){const x=st.get("WEBGL_lose_context");x&&x.loseContext()},this.forceContextRestore=function(){const x=st.get("WEBGL_lose_context");x&&x.restoreContext()},this.getPixelRatio=function(){return fe},this.setPixelRatio=function(x){x!==void 0&&(fe=x,this.setSize(ve,Ee,!1))},this.getSize=function(x){return x.set(ve,Ee)},this.setSize=function(x,C,G=!0){if(ie.isPresenting){Le("WebGLRenderer: Can't change size while VR device is presenting.");return}ve=x,Ee=C,t.width=Math.floor(x*fe),t.height=Math.floor(C*fe),G===!0&&(t.style.width=x+"px",t.style.height=C+"px"),k!==null&&k.setSize(t.width,t.height),this.setViewport(0,0,x,C)},this.getDrawingBufferSize=function(x){return x.set(ve*fe,Ee*fe).floor()},this.setDrawingBufferSize=function(x,C,G){ve=x,Ee=C,fe=G,t.width=Math.floor(x*G),t.height=Math.floor(C*G),this.setViewport(0,0,x,C)},this.setEffects=function(x){if(S===1009){Je("WebGLRenderer: setEffects() requires outputBufferType set to HalfFloatType or FloatType.");return}if(x){for(let C=0;C<x.length;C++)if(x[C].isOutputPass===!0){Le("WebGLRenderer: OutputPass is not needed in setEffects(). Tone mapping and color space conversion are applied automatically.");break}}k.setEffects(x||[])},this.getCurrentViewport=function(x){return x.copy(ee)},this.getViewport=function(x){return x.copy(Te)},this.setViewport=function(x,C,G,U){x.isVector4?Te.set(x.x,x.y,x.z,x.w):Te.set(x,C,G,U),pe.viewport(ee.copy(Te).multiplyScalar(Wt()).round())},this.getScissor=function(x){return x.copy(He)},this.setScissor=function(x,C,G,U){x.isVector4?He.set(x.x,x.y,x.z,x.w):He.set(x,C,G,U),pe.scissor(we.copy(He).multiplyScalar(Wt()).round())},this.getScissorTest=function(){return Ne},this.setScissorTest=function(x){pe.setScissorTest(Ne=x)},this.setOpaqueSort=function(x){De=x},this.setTransparentSort=function(x){Ke=x},this.getClearColor=function(x){return x.copy(T.getClearColor())},this.setClearColor=function(){T.setClearColor(...arguments)},this.getClearAlpha=function(){return T.getClearAlpha()},this.setClearAlpha=function(){T.setClearAlpha(...arguments)},this.clear=function(x=!0,C=!0,G=!0){let U=0;if(x){let B=!1;if(te!==null){const ue=te.texture.format;B=m.has(ue)}if(B){const ue=te.texture.type,xe=p.has(ue),ce=T.getClearColor(),_e=T.getClearAlpha(),ye=ce.r,Ie=ce.g,Ve=ce.b;xe?(M[0]=ye,M[1]=Ie,M[2]=Ve,M[3]=_e,F.clearBufferuiv(F.COLOR,0,M)):(A[0]=ye,A[1]=Ie,A[2]=Ve,A[3]=_e,F.clearBufferiv(F.COLOR,0,A))}else U|=F.COLOR_BUFFER_BIT}C&&(U|=F.DEPTH_BUFFER_BIT,this.state.buffers.depth.setMask(!0)),G&&(U|=F.STENCIL_BUFFER_BIT,this.state.buffers.stencil.setMask(4294967295)),U!==0&&F.clear(U)},this.clearColor=function(){this.clear(!0,!1,!1)},this.clearDepth=function(){this.clear(!1,!0,!1)},this.clearStencil=function(){this.clear(!1,!1,!0)},this.setNodesHandler=function(x){x.setRenderer(this),z=x},this.dispose=function(){t.removeEventListener("webglcontextlost",Re,!1),t.removeEventListener("webglcontextrestored",Oe,!1),t.removeEventListener("webglcontextcreationerror",me,!1),T.dispose(),de.dispose(),Y.dispose(),Fe.dispose(),Ce.dispose(),w.dispose(),ne.dispose(),O.dispose(),ae.dispose(),be.dispose(),Q.dispose(),ie.dispose(),ie.removeEventListener("sessionstart",jr),ie.removeEventListener("sessionend",ea),On.stop()};function Re(x){x.preventDefault(),da("WebGLRenderer: Context Lost."),I=!0}function Oe(){da("WebGLRenderer: Context Restored."),I=!1;const x=_t.autoReset,C=oe.enabled,G=oe.autoUpdate,U=oe.needsUpdate,B=oe.type;ke(),_t.autoReset=x,oe.enabled=C,oe.autoUpdate=G,oe.needsUpdate=U,oe.type=B}function me(x){Je("WebGLRenderer: A WebGL context could not be created. Reason: ",x.statusMessage)}function et(x){const C=x.target;C.removeEventListener("dispose",et),wt(C)}function wt(x){An(x),Ce.remove(x)}function An(x){const C=Ce.get(x).programs;C!==void 0&&(C.forEach(function(G){Q.releaseProgram(G)}),x.isShaderMaterial&&Q.releaseShaderCache(x))}this.renderBufferDirect=function(x,C,G,U,B,ue){C===null&&(C=Ht);const xe=B.isMesh&&B.matrixWorld.determinantAffine()<0,ce=Ml(x,C,G,U,B);pe.setMaterial(U,xe);let _e=G.index,ye=1;if(U.wireframe===!0){if(_e=O.getWireframeAttribute(G),_e===void 0)return;ye=2}const Ie=G.drawRange,Ve=G.attributes.position;let Se=Ie.start*ye,We=(Ie.start+Ie.count)*ye;ue!==null&&(Se=Math.max(Se,ue.start*ye),We=Math.min(We,(ue.start+ue.count)*ye)),_e!==null?(Se=Math.max(Se,0),We=Math.min(We,_e.count)):Ve!=null&&(Se=Math.max(Se,0),We=Math.min(We,Ve.count));const pt=We-Se;if(pt<0||pt===1/0)return;ae.setup(B,U,ce,G,_e);let it,nt=X;if(_e!==null&&(it=v.get(_e),nt=le,nt.setIndex(it)),B.isMesh)U.wireframe===!0?(pe.setLineWidth(U.wireframeLinewidth*Wt()),nt.setMode(F.LINES)):nt.setMode(F.TRIANGLES);else if(B.isLine){let Rt=U.linewidth;Rt===void 0&&(Rt=1),pe.setLineWidth(Rt*Wt()),B.isLineSegments?nt.setMode(F.LINES):B.isLineLoop?nt.setMode(F.LINE_LOOP):nt.setMode(F.LINE_STRIP)}else B.isPoints?nt.setMode(F.POINTS):B.isSprite&&nt.setMode(F.TRIANGLES);if(B.isBatchedMesh)if(st.get("WEBGL_multi_draw"))nt.renderMultiDraw(B._multiDrawStarts,B._multiDrawCounts,B._multiDrawCount);else{const Rt=B._multiDrawStarts,Me=B._multiDrawCounts,Dt=B._multiDrawCount,je=_e?v.get(_e).bytesPerElement:1,Bn=Ce.get(U).currentProgram.getUniforms();for(let Ct=0;Ct<Dt;Ct++)Bn.setValue(F,"_gl_DrawID",Ct),nt.render(Rt[Ct]/je,Me[Ct])}else if(B.isInstancedMesh)nt.renderInstances(Se,pt,B.count);else if(G.isInstancedBufferGeometry){const Rt=G._maxInstanceCount!==void 0?G._maxInstanceCount:1/0,Me=Math.min(G.instanceCount,Rt);nt.renderInstances(Se,pt,Me)}else nt.render(Se,pt)};function Qr(x,C,G,U){z!==null&&x.isNodeMaterial&&z.setObject(U,x),at===!0&&K.setState(x,G,!1),x.transparent===!0&&x.side===2&&x.forceSinglePass===!1?(x.side=1,x.needsUpdate=!0,bi(x,C,U),x.side=0,x.needsUpdate=!0,bi(x,C,U),x.side=2):bi(x,C,U)}this.compile=function(x,C,G=null){G===null&&(G=x),z!==null&&z.renderStart(x,C,G),E=Y.get(G),E.init(C),y.push(E),G.traverseVisible(function(B){B.isLight&&B.layers.test(C.layers)&&(E.pushLight(B),B.castShadow&&E.pushShadow(B))}),x!==G&&x.traverseVisible(function(B){B.isLight&&B.layers.test(C.layers)&&(E.pushLight(B),B.castShadow&&E.pushShadow(B))}),E.setupLights(),z!==null&&z.updateLights(E.state.lightsArray),Ut=this.localClippingEnabled,at=K.init(this.clippingPlanes,Ut),at===!0&&K.setGlobalState(this.clippingPlanes,C),z!==null&&oe.render(E.state.shadowsArray,G,C);const U=new Set;return x.traverse(function(B){if(!(B.isMesh||B.isPoints||B.isLine||B.isSprite))return;const ue=B.material;if(ue)if(Array.isArray(ue))for(let xe=0;xe<ue.length;xe++){const ce=ue[xe];Qr(ce,G,C,B),U.add(ce)}else Qr(ue,G,C,B),U.add(ue)}),E=y.pop(),z!==null&&z.renderEnd(),U},this.compileAsync=function(x,C,G=null){const U=this.compile(x,C,G);return new Promise(B=>{function ue(){if(U.forEach(function(xe){const _e=Ce.get(xe).currentProgram;(_e===void 0||_e.isReady())&&U.delete(xe)}),U.size===0){B(x);return}setTimeout(ue,10)}st.get("KHR_parallel_shader_compile")!==null?ue():setTimeout(ue,10)})};let Zs=null;function xl(x){Zs&&Zs(x)}function jr(){On.stop()}function ea(){On.start()}const On=new zo;On.setAnimationLoop(xl),typeof self<"u"&&On.setContext(self),this.setAnimationLoop=function(x){Zs=x,ie.setAnimationLoop(x),x===null?On.stop():On.start()},ie.addEventListener("sessionstart",jr),ie.addEventListener("sessionend",ea),this.render=function(x,C){if(C!==void 0&&C.isCamera!==!0){Je("WebGLRenderer.render: camera is not an instance of THREE.Camera.");return}if(I===!0)return;z!==null&&z.renderStart(x,C);const G=ie.enabled===!0&&ie.isPresenting===!0,U=k!==null&&(te===null||G)&&k.begin(N,te);if(x.matrixWorldAutoUpdate===!0&&x.updateMatrixWorld(),C.parent===null&&C.matrixWorldAutoUpdate===!0&&C.updateMatrixWorld(),ie.enabled===!0&&ie.isPresenting===!0&&(k===null||k.isCompositing()===!1)&&(ie.cameraAutoUpdate===!0&&ie.updateCamera(C),C=ie.getCamera()),x.isScene===!0&&x.onBeforeRender(N,x,C,te),E=Y.get(x,y.length),E.init(C),E.state.textureUnits=Fe.getTextureUnits(),y.push(E),ot.multiplyMatrices(C.projectionMatrix,C.matrixWorldInverse),C.isArrayCamera?dt.setFromArrayCamera(C):Be.setFromProjectionMatrix(ot,2e3,C.reversedDepth),Ut=this.localClippingEnabled,at=K.init(this.clippingPlanes,Ut),R=de.get(x,_.length),R.init(),_.push(R),this.info.render.frame++,ie.enabled===!0&&ie.isPresenting===!0){const xe=N.xr.getDepthSensingMesh();xe!==null&&Js(xe,C,-1/0,N.sortObjects)}Js(x,C,0,N.sortObjects),R.finish(),z!==null&&z.updateLights(E.state.lightsArray),N.sortObjects===!0&&R.sort(De,Ke),Vt=ie.enabled===!1||ie.isPresenting===!1||ie.hasDepthSensing()===!1,Vt&&T.addToRenderList(R,x),this.info.autoReset===!0&&this.info.reset(),at===!0&&K.beginShadows();const B=E.state.shadowsArray;if(oe.render(B,x,C),at===!0&&K.endShadows(),(U&&k.hasRenderPass())===!1){const xe=R.opaque,ce=R.transmissive;if(E.setupLights(),C.isArrayCamera){const _e=C.cameras;if(ce.length>0)for(let ye=0,Ie=_e.length;ye<Ie;ye++){const Ve=_e[ye];na(xe,ce,x,Ve)}Vt&&T.render(x);for(let ye=0,Ie=_e.length;ye<Ie;ye++){const Ve=_e[ye];ta(R,x,Ve,Ve.viewport)}}else ce.length>0&&na(xe,ce,x,C),Vt&&T.render(x),ta(R,x,C)}te!==null&&H===0&&(Fe.updateMultisampleRenderTarget(te),Fe.updateRenderTargetMipmap(te)),U&&k.end(N),x.isScene===!0&&x.onAfterRender(N,x,C),ae.resetDefaultState(),V=-1,j=null,y.pop(),y.length>0?(E=y[y.length-1],Fe.setTextureUnits(E.state.textureUnits),at===!0&&K.setGlobalState(N.clippingPlanes,E.state.camera)):E=null,_.pop(),_.length>0?R=_[_.length-1]:R=null,z!==null&&z.renderEnd()};function Js(x,C,G,U){if(x.visible===!1)return;if(x.layers.test(C.layers)){if(x.isGroup)G=x.renderOrder;else if(x.isLOD)x.autoUpdate===!0&&x.update(C);else if(x.isLight)E.pushLight(x),x.castShadow&&E.pushShadow(x);else if(x.isSprite){const xe=C.isArrayCamera?dt:Be;if(!x.frustumCulled||x.intersectsFrustum(xe)){U&&Mt.setFromMatrixPosition(x.matrixWorld).applyMatrix4(ot);const ce=ne.update(x),_e=x.material;_e.visible&&R.push(x,ce,_e,G,Mt.z,null,C)}}else if(x.isMesh||x.isLine||x.isPoints){const xe=C.isArrayCamera?dt:Be;if(!x.frustumCulled||x.intersectsFrustum(xe)){const ce=ne.update(x),_e=x.material;if(U&&(x.boundingSphere!==void 0?(x.boundingSphere===null&&x.computeBoundingSphere(),Mt.copy(x.boundingSphere.center)):(ce.boundingSphere===null&&ce.computeBoundingSphere(),Mt.copy(ce.boundingSphere.center)),Mt.applyMatrix4(x.matrixWorld).applyMatrix4(ot)),Array.isArray(_e)){const ye=ce.groups;for(let Ie=0,Ve=ye.length;Ie<Ve;Ie++){const Se=ye[Ie],We=_e[Se.materialIndex];We&&We.visible&&R.push(x,ce,We,G,Mt.z,Se,C)}}else _e.visible&&R.push(x,ce,_e,G,Mt.z,null,C)}}}const ue=x.children;for(let xe=0,ce=ue.length;xe<ce;xe++)Js(ue[xe],C,G,U)}function ta(x,C,G,U){const{opaque:B,transmissive:ue,transparent:xe}=x;E.setupLightsView(G),at===!0&&K.setGlobalState(N.clippingPlanes,G),U&&pe.viewport(ee.copy(U)),B.length>0&&Wi(B,C,G),ue.length>0&&Wi(ue,C,G),xe.length>0&&Wi(xe,C,G),pe.buffers.depth.setTest(!0),pe.buffers.depth.setMask(!0),pe.buffers.color.setMask(!0),pe.setPolygonOffset(!1)}function na(x,C,G,U){if((G.isScene===!0?G.overrideMaterial:null)!==null)return;if(E.state.transmissionRenderTarget[U.id]===void 0){const Se=st.has("EXT_color_buffer_half_float")||st.has("EXT_color_buffer_float");E.state.transmissionRenderTarget[U.id]=new Zt(1,1,{generateMipmaps:!0,type:Se?1016:1009,minFilter:1008,samples:Math.max(4,rt.samples),stencilBuffer:r,resolveDepthBuffer:!1,resolveStencilBuffer:!1,storeMultisampledDepthBuffer:!1,storeMultisampledStencilBuffer:!1,colorSpace:qe.workingColorSpace})}const ue=E.state.transmissionRenderTarget[U.id],xe=U.viewport||ee;ue.setSize(xe.z*N.transmissionResolutionScale,xe.w*N.transmissionResolutionScale);const ce=N.getRenderTarget(),_e=N.getActiveCubeFace(),ye=N.getActiveMipmapLevel();N.setRenderTarget(ue),N.getClearColor(q),he=N.getClearAlpha(),he<1&&N.setClearColor(16777215,.5),N.clear(),Vt&&T.render(G);const Ie=N.toneMapping;N.toneMapping=0;const Ve=U.viewport;if(U.viewport!==void 0&&(U.viewport=void 0),E.setupLightsView(U),at===!0&&K.setGlobalState(N.clippingPlanes,U),Wi(x,G,U),Fe.updateMultisampleRenderTarget(ue),Fe.updateRenderTargetMipmap(ue),st.has("WEBGL_multisampled_render_to_texture")===!1){let Se=!1;for(let We=0,pt=C.length;We<pt;We++){const it=C[We],{object:nt,geometry:Rt,material:Me,group:Dt}=it;if(Me.side===2&&nt.layers.test(U.layers)){const je=Me.side;Me.side=1,Me.needsUpdate=!0,ia(nt,G,U,Rt,Me,Dt),Me.side=je,Me.needsUpdate=!0,Se=!0}}Se===!0&&(Fe.updateMultisampleRenderTarget(ue),Fe.updateRenderTargetMipmap(ue))}N.setRenderTarget(ce,_e,ye),N.setClearColor(q,he),Ve!==void 0&&(U.viewport=Ve),N.toneMapping=Ie}function Wi(x,C,G){const U=C.isScene===!0?C.overrideMaterial:null;for(let B=0,ue=x.length;B<ue;B++){const xe=x[B],{object:ce,geometry:_e,group:ye}=xe;let Ie=xe.material;Ie.allowOverride===!0&&U!==null&&(Ie=U),ce.layers.test(G.layers)&&ia(ce,C,G,_e,Ie,ye)}}function ia(x,C,G,U,B,ue){z!==null&&B.isNodeMaterial&&z.setObject(x,B),x.onBeforeRender(N,C,G,U,B,ue),x.modelViewMatrix.multiplyMatrices(G.matrixWorldInverse,x.matrixWorld),x.normalMatrix.getNormalMatrix(x.modelViewMatrix),B.onBeforeRender(N,C,G,U,x,ue),B.transparent===!0&&B.side===2&&B.forceSinglePass===!1?(B.side=1,B.needsUpdate=!0,N.renderBufferDirect(G,C,U,B,x,ue),B.side=0,B.needsUpdate=!0,N.renderBufferDirect(G,C,U,B,x,ue),B.side=2):N.renderBufferDirect(G,C,U,B,x,ue),x.onAfterRender(N,C,G,U,B,ue)}function sa(x){let C=0;for(const G of x)G.texture!==null&&C++;return C}function bi(x,C,G){C.isScene!==!0&&(C=Ht);const U=Ce.get(x),B=E.state.lights,ue=E.state.shadowsArray,xe=B.state.version,ce=Q.getParameters(x,B.state,ue,C,G,E.state.lightProbeGridArray),_e=Q.getProgramCacheKey(ce);let ye=U.programs;U.environment=x.isMeshStandardMaterial||x.isMeshLambertMaterial||x.isMeshPhongMaterial?C.environment:null,U.fog=C.fog;const Ie=x.isMeshStandardMaterial||x.isMeshLambertMaterial&&!x.envMap||x.isMeshPhongMaterial&&!x.envMap;U.envMap=w.get(x.envMap||U.environment,Ie),U.envMapRotation=U.environment!==null&&x.envMap===null?C.environmentRotation:x.envMapRotation,ye===void 0&&(x.addEventListener("dispose",et),ye=new Map,U.programs=ye,U.programVariants=new Map);let Ve=ye.get(_e);if(Ve!==void 0){if(U.currentProgram===Ve&&U.lightsStateVersion===xe)return aa(x,ce),Ve}else ce.uniforms=Q.getUniforms(x),z!==null&&x.isNodeMaterial&&z.build(x,G,ce),x.onBeforeCompile(ce,N),Ve=Q.acquireProgram(ce,_e),ye.set(_e,Ve),U.uniforms=ce.uniforms;const Se=U.uniforms;return(!x.isShaderMaterial&&!x.isRawShaderMaterial||x.clipping===!0)&&(Se.clippingPlanes=K.uniform),aa(x,ce),U.needsLights=yl(x),U.lightsStateVersion=xe,U.needsLights&&(Se.ambientLightColor.value=B.state.ambient,Se.lightProbe.value=B.state.probe,Se.sunLights.value=B.state.sun,Se.sunLightShadows.value=B.state.sunShadow,Se.directionalLights.value=B.state.directional,Se.directionalLightShadows.value=B.state.directionalShadow,Se.spotLights.value=B.state.spot,Se.spotLightShadows.value=B.state.spotShadow,Se.rectAreaLights.value=B.state.rectArea,Se.ltc_1.value=B.state.rectAreaLTC1,Se.ltc_2.value=B.state.rectAreaLTC2,Se.pointLights.value=B.state.point,Se.pointLightShadows.value=B.state.pointShadow,Se.hemisphereLights.value=B.state.hemi,Se.sunShadowMatrix.value=B.state.sunShadowMatrix,Se.sunShadowCascade.value=B.state.sunShadowCascade,Se.directionalShadowMatrix.value=B.state.directionalShadowMatrix,Se.spotLightMatrix.value=B.state.spotLightMatrix,Se.spotLightMap.value=B.state.spotLightMap,Se.pointShadowMatrix.value=B.state.pointShadowMatrix),U.numLightProbeGrids=sa(E.state.lightProbeGridArray),U.currentProgram=Ve,U.uniformsList=null,Ve}function Sl(x,C,G,U,B){const ue=Ce.get(x),xe=ue.currentProgram.id+","+U+","+B;let ce=ue.programVariants.get(xe);return ce===void 0?(ce=bi(x,C,G),ue.programVariants.set(xe,ce)):(ue.currentProgram=ce,ue.uniformsList=null,ue.outputColorSpace=U,ue.toneMapping=B),ce}function ra(x){if(x.uniformsList===null){const C=x.currentProgram.getUniforms();x.uniformsList=As.seqWithValue(C.seq,x.uniforms)}return x.uniformsList}function aa(x,C){const G=Ce.get(x);G.outputColorSpace=C.outputColorSpace,G.batching=C.batching,G.batchingColor=C.batchingColor,G.instancing=C.instancing,G.instancingColor=C.instancingColor,G.instancingMorph=C.instancingMorph,G.skinning=C.skinning,G.morphTargets=C.morphTargets,G.morphNormals=C.morphNormals,G.morphColors=C.morphColors,G.morphTargetsCount=C.morphTargetsCount,G.numClippingPlanes=C.numClippingPlanes,G.numIntersection=C.numClipIntersection,G.vertexAlphas=C.vertexAlphas,G.vertexTangents=C.vertexTangents,G.toneMapping=C.toneMapping}function Ml(x,C,G,U,B){C.isScene!==!0&&(C=Ht),Fe.resetTextureUnits();const ue=C.fog,xe=U.isMeshStandardMaterial||U.isMeshLambertMaterial||U.isMeshPhongMaterial?C.environment:null,ce=te===null?N.outputColorSpace:te.isXRRenderTarget===!0?te.texture.colorSpace:qe.workingColorSpace,_e=U.isMeshStandardMaterial||U.isMeshLambertMaterial&&!U.envMap||U.isMeshPhongMaterial&&!U.envMap,ye=w.get(U.envMap||xe,_e),Ie=U.vertexColors===!0&&!!G.attributes.color&&G.attributes.color.itemSize===4,Ve=!!G.attributes.tangent&&(!!U.normalMap||U.anisotropy>0),Se=!!G.morphAttributes.position,We=!!G.morphAttributes.normal,pt=!!G.morphAttributes.color;let it=0;U.toneMapped&&(te===null||te.isXRRenderTarget===!0)&&(it=N.toneMapping);const nt=G.morphAttributes.position||G.morphAttributes.normal||G.morphAttributes.color,Rt=nt!==void 0?nt.length:0,Me=Ce.get(U),Dt=E.state.lights;if(at===!0&&(Ut===!0||x!==j)){const lt=x===j&&U.id===V;K.setState(U,x,lt)}let je=!1,Bn=!1;U.version===Me.__version?Me.needsLights&&Me.lightsStateVersion!==Dt.state.version||B.isBatchedMesh&&Me.batching===!1||!B.isBatchedMesh&&Me.batching===!0||B.isBatchedMesh&&Me.batchingColor===!0&&B._colorsTexture===null||B.isBatchedMesh&&Me.batchingColor===!1&&B._colorsTexture!==null||B.isInstancedMesh&&Me.instancing===!1||!B.isInstancedMesh&&Me.instancing===!0||B.isSkinnedMesh&&Me.skinning===!1||!B.isSkinnedMesh&&Me.skinning===!0||B.isInstancedMesh&&Me.instancingColor===!0&&B.instanceColor===null||B.isInstancedMesh&&Me.instancingColor===!1&&B.instanceColor!==null||B.isInstancedMesh&&Me.instancingMorph===!0&&B.morphTexture===null||B.isInstancedMesh&&Me.instancingMorph===!1&&B.morphTexture!==null||Me.envMap!==ye||U.fog===!0&&Me.fog!==ue||Me.numClippingPlanes!==void 0&&(Me.numClippingPlanes!==K.numPlanes||Me.numIntersection!==K.numIntersection)||Me.vertexAlphas!==Ie||Me.vertexTangents!==Ve||Me.morphTargets!==Se||Me.morphNormals!==We||Me.morphColors!==pt||Me.morphTargetsCount!==Rt||Me.numLightProbeGrids!==sa(E.state.lightProbeGridArray)?je=!0:(Me.outputColorSpace!==ce||Me.toneMapping!==it)&&(Bn=!0):(je=!0,Me.__version=U.version);let Ct=Me.currentProgram;(je===!0||Bn===!0)&&(Ct=Bn===!0?Sl(U,C,B,ce,it):bi(U,C,B),z&&U.isNodeMaterial&&z.onUpdateProgram(U,Ct,Me));let Xi=!1,Rn=!1,kn=!1;const Ze=Ct.getUniforms(),Tt=Me.uniforms;if(pe.useProgram(Ct.program)&&(Xi=!0,Rn=!0,kn=!0),U.id!==V&&(V=U.id,Rn=!0),Xi||j!==x){pe.buffers.depth.getReversed()&&x.reversedDepth!==!0&&(x._reversedDepth=!0,x.updateProjectionMatrix()),Ze.setValue(F,"projectionMatrix",x.projectionMatrix),Ze.setValue(F,"viewMatrix",x.matrixWorldInverse);const yt=Ze.map.cameraPosition;yt!==void 0&&yt.setValue(F,an.setFromMatrixPosition(x.matrixWorld)),rt.logarithmicDepthBuffer&&Ze.setValue(F,"logDepthBufFC",2/(Math.log(x.far+1)/Math.LN2)),(U.isMeshPhongMaterial||U.isMeshToonMaterial||U.isMeshLambertMaterial||U.isMeshBasicMaterial||U.isMeshStandardMaterial||U.isShaderMaterial)&&Ze.setValue(F,"isOrthographic",x.isOrthographicCamera===!0),j!==x&&(j=x,Rn=!0,kn=!0)}if(Me.needsLights&&(Dt.state.sunShadowMap.length>0&&Ze.setValue(F,"sunShadowMap",Dt.state.sunShadowMap,Fe),Dt.state.directionalShadowMap.length>0&&Ze.setValue(F,"directionalShadowMap",Dt.state.directionalShadowMap,Fe),Dt.state.spotShadowMap.length>0&&Ze.setValue(F,"spotShadowMap",Dt.state.spotShadowMap,Fe),Dt.state.pointShadowMap.length>0&&Ze.setValue(F,"pointShadowMap",Dt.state.pointShadowMap,Fe)),B.isSkinnedMesh){Ze.setOptional(F,B,"bindMatrix"),Ze.setOptional(F,B,"bindMatrixInverse");const lt=B.skeleton;lt&&(lt.boneTexture===null&&lt.computeBoneTexture(),Ze.setValue(F,"boneTexture",lt.boneTexture,Fe))}B.isBatchedMesh&&(Ze.setOptional(F,B,"batchingTexture"),Ze.setValue(F,"batchingTexture",B._matricesTexture,Fe),Ze.setOptional(F,B,"batchingIdTexture"),Ze.setValue(F,"batchingIdTexture",B._indirectTexture,Fe),Ze.setOptional(F,B,"batchingColorTexture"),B._colorsTexture!==null&&Ze.setValue(F,"batchingColorTexture",B._colorsTexture,Fe));const Qt=G.morphAttributes;if((Qt.position!==void 0||Qt.normal!==void 0||Qt.color!==void 0)&&J.update(B,G,Ct),(Rn||Me.receiveShadow!==B.receiveShadow)&&(Me.receiveShadow=B.receiveShadow,Ze.setValue(F,"receiveShadow",B.receiveShadow)),(U.isMeshStandardMaterial||U.isMeshLambertMaterial||U.isMeshPhongMaterial)&&U.envMap===null&&C.environment!==null&&(Tt.envMapIntensity.value=C.environmentIntensity),Tt.dfgLUT!==void 0&&(Tt.dfgLUT.value=sp()),Rn){if(Ze.setValue(F,"toneMappingExposure",N.toneMappingExposure),Me.needsLights&&wl(Tt,kn),ue&&U.fog===!0&&re.refreshFogUniforms(Tt,ue),re.refreshMaterialUniforms(Tt,U,fe,Ee,E.state.transmissionRenderTarget[x.id]),Me.needsLights&&Me.numLightProbeGrids>0){const lt=b;let yt=0;for(const gn of E.state.lightProbeGridArray)gn.texture!==null&&(lt.textures[yt]=gn.texture,lt.min[yt]=gn.boundingBox.min,lt.max[yt]=gn.boundingBox.max,lt.resolution[yt]=gn.resolution,yt++);for(const gn in lt)lt[gn].length=yt;Tt.probesSH.value=lt.textures,Tt.probesMin.value=lt.min,Tt.probesMax.value=lt.max,Tt.probesResolution.value=lt.resolution}As.upload(F,ra(Me),Tt,Fe)}if(U.isShaderMaterial&&U.uniformsNeedUpdate===!0&&(As.upload(F,ra(Me),Tt,Fe),U.uniformsNeedUpdate=!1),U.isSpriteMaterial&&Ze.setValue(F,"center",B.center),Ze.setValue(F,"modelViewMatrix",B.modelViewMatrix),Ze.setValue(F,"normalMatrix",B.normalMatrix),Ze.setValue(F,"modelMatrix",B.matrixWorld),U.uniformsGroups!==void 0){const lt=U.uniformsGroups;for(let yt=0,gn=lt.length;yt<gn;yt++){const la=lt[yt];be.update(la,Ct),be.bind(la,Ct)}}return Ct}function wl(x,C){x.ambientLightColor.needsUpdate=C,x.lightProbe.needsUpdate=C,x.sunLights.needsUpdate=C,x.sunLightShadows.needsUpdate=C,x.directionalLights.needsUpdate=C,x.directionalLightShadows.needsUpdate=C,x.pointLights.needsUpdate=C,x.pointLightShadows.needsUpdate=C,x.spotLights.needsUpdate=C,x.spotLightShadows.needsUpdate=C,x.rectAreaLights.needsUpdate=C,x.hemisphereLights.needsUpdate=C}function yl(x){return x.isMeshLambertMaterial||x.isMeshToonMaterial||x.isMeshPhongMaterial||x.isMeshStandardMaterial||x.isShadowMaterial||x.isShaderMaterial&&x.lights===!0}this.getActiveCubeFace=function(){return Z},this.getActiveMipmapLevel=function(){return H},this.getRenderTarget=function(){return te},this.setRenderTargetTextures=function(x,C,G){const U=Ce.get(x);U.__autoAllocateDepthBuffer=x.resolveDepthBuffer===!1,U.__autoAllocateDepthBuffer===!1&&(U.__useRenderToTexture=!1),Ce.get(x.texture).__webglTexture=C,Ce.get(x.depthTexture).__webglTexture=U.__autoAllocateDepthBuffer?void 0:G,U.__hasExternalTextures=!0},this.setRenderTargetFramebuffer=function(x,C){const G=Ce.get(x);G.__webglFramebuffer=C,G.__useDefaultFramebuffer=C===void 0},this.setRenderTarget=function(x,C=0,G=0){te=x,Z=C,H=G;let U=null,B=!1,ue=!1;if(x){const ce=Ce.get(x);if(ce.__useDefaultFramebuffer!==void 0){pe.bindFramebuffer(F.FRAMEBUFFER,ce.__webglFramebuffer),ee.copy(x.viewport),we.copy(x.scissor),Pe=x.scissorTest,pe.viewport(ee),pe.scissor(we),pe.setScissorTest(Pe),V=-1;return}else if(ce.__webglFramebuffer===void 0)Fe.setupRenderTarget(x);else if(ce.__hasExternalTextures)Fe.rebindTextures(x,Ce.get(x.texture).__webglTexture,Ce.get(x.depthTexture).__webglTexture);else if(x.depthBuffer){const Ie=x.depthTexture;if(ce.__boundDepthTexture!==Ie){if(Ie!==null&&Ce.has(Ie)&&(x.width!==Ie.image.width||x.height!==Ie.image.height))throw new Error("THREE.WebGLRenderer: Attached DepthTexture is initialized to the incorrect size.");Fe.setupDepthRenderbuffer(x)}}const _e=x.texture;(_e.isData3DTexture||_e.isDataArrayTexture||_e.isCompressedArrayTexture)&&(ue=!0);const ye=Ce.get(x).__webglFramebuffer;x.isWebGLCubeRenderTarget?(Array.isArray(ye[C])?U=ye[C][G]:U=ye[C],B=!0):x.samples>0&&Fe.useMultisampledRTT(x)===!1?U=Ce.get(x).__webglMultisampledFramebuffer:Array.isArray(ye)?U=ye[G]:U=ye,ee.copy(x.viewport),we.copy(x.scissor),Pe=x.scissorTest}else ee.copy(Te).multiplyScalar(fe).floor(),we.copy(He).multiplyScalar(fe).floor(),Pe=Ne;if(G!==0&&(U=$),pe.bindFramebuffer(F.FRAMEBUFFER,U)&&pe.drawBuffers(x,U),pe.viewport(ee),pe.scissor(we),pe.setScissorTest(Pe),B){const ce=Ce.get(x.texture);F.framebufferTexture2D(F.FRAMEBUFFER,F.COLOR_ATTACHMENT0,F.TEXTURE_CUBE_MAP_POSITIVE_X+C,ce.__webglTexture,G)}else if(ue){const ce=C;for(let _e=0;_e<x.textures.length;_e++){const ye=Ce.get(x.textures[_e]);F.framebufferTextureLayer(F.FRAMEBUFFER,F.COLOR_ATTACHMENT0+_e,ye.__webglTexture,G,ce)}}else if(x!==null&&G!==0){const ce=Ce.get(x.texture);F.framebufferTexture2D(F.FRAMEBUFFER,F.COLOR_ATTACHMENT0,F.TEXTURE_2D,ce.__webglTexture,G)}V=-1};function oa(x){const C=Ce.get(x);return(C.__readFormat!==x.format||C.__readType!==x.type)&&(C.__readFormat=x.format,C.__readType=x.type,C.__formatReadable=rt.textureFormatReadable(x.format),C.__typeReadable=rt.textureTypeReadable(x.type)),C}this.readRenderTargetPixels=function(x,C,G,U,B,ue,xe,ce=0){if(!(x&&x.isWebGLRenderTarget)){Je("WebGLRenderer.readRenderTargetPixels: renderTarget is not THREE.WebGLRenderTarget.");return}let _e=Ce.get(x).__webglFramebuffer;if(x.isWebGLCubeRenderTarget&&xe!==void 0&&(_e=_e[xe],Array.isArray(_e)&&(_e=_e[0])),_e){pe.bindFramebuffer(F.FRAMEBUFFER,_e);try{const ye=x.textures[ce],Ie=ye.format,Ve=ye.type;x.textures.length>1&&F.readBuffer(F.COLOR_ATTACHMENT0+ce);const Se=oa(ye);if(Se.__formatReadable===!1){Je("WebGLRenderer.readRenderTargetPixels: renderTarget is not in RGBA or implementation defined format.");return}if(Se.__typeReadable===!1){Je("WebGLRenderer.readRenderTargetPixels: renderTarget is not in UnsignedByteType or implementation defined type.");return}C>=0&&C<=x.width-U&&G>=0&&G<=x.height-B&&F.readPixels(C,G,U,B,se.convert(Ie),se.convert(Ve),ue)}finally{const ye=te!==null?Ce.get(te).__webglFramebuffer:null;pe.bindFramebuffer(F.FRAMEBUFFER,ye)}}},this.readRenderTargetPixelsAsync=async function(x,C,G,U,B,ue,xe,ce=0){if(!(x&&x.isWebGLRenderTarget))throw new Error("THREE.WebGLRenderer.readRenderTargetPixels: renderTarget is not THREE.WebGLRenderTarget.");let _e=Ce.get(x).__webglFramebuffer;if(x.isWebGLCubeRenderTarget&&xe!==void 0&&(_e=_e[xe],Array.isArray(_e)&&(_e=_e[0])),_e)if(C>=0&&C<=x.width-U&&G>=0&&G<=x.height-B){pe.bindFramebuffer(F.FRAMEBUFFER,_e);const ye=x.textures[ce],Ie=ye.format,Ve=ye.type;x.textures.length>1&&F.readBuffer(F.COLOR_ATTACHMENT0+ce);const Se=oa(ye);if(Se.__formatReadable===!1)throw new Error("THREE.WebGLRenderer.readRenderTargetPixelsAsync: renderTarget is not in RGBA or implementation defined format.");if(Se.__typeReadable===!1)throw new Error("THREE.WebGLRenderer.readRenderTargetPixelsAsync: renderTarget is not in UnsignedByteType or implementation defined type.");const We=F.createBuffer();F.bindBuffer(F.PIXEL_PACK_BUFFER,We),F.bufferData(F.PIXEL_PACK_BUFFER,ue.byteLength,F.STREAM_READ),F.readPixels(C,G,U,B,se.convert(Ie),se.convert(Ve),0),F.bindBuffer(F.PIXEL_PACK_BUFFER,null);const pt=te!==null?Ce.get(te).__webglFramebuffer:null;pe.bindFramebuffer(F.FRAMEBUFFER,pt);const it=F.fenceSync(F.SYNC_GPU_COMMANDS_COMPLETE,0);return F.flush(),await Tl(F,it,4),F.bindBuffer(F.PIXEL_PACK_BUFFER,We),F.getBufferSubData(F.PIXEL_PACK_BUFFER,0,ue),F.bindBuffer(F.PIXEL_PACK_BUFFER,null),F.deleteBuffer(We),F.deleteSync(it),ue}else throw new Error("THREE.WebGLRenderer.readRenderTargetPixelsAsync: requested read bounds are out of range.")},this.copyFramebufferToTexture=function(x,C=null,G=0){const U=Math.pow(2,-G),B=Math.floor(x.image.width*U),ue=Math.floor(x.image.height*U),xe=C!==null?C.x:0,ce=C!==null?C.y:0;Fe.setTexture2D(x,0),F.copyTexSubImage2D(F.TEXTURE_2D,G,0,0,xe,ce,B,ue),pe.unbindTexture()},this.copyTextureToTexture=function(x,C,G=null,U=null,B=0,ue=0){let xe,ce,_e,ye,Ie,Ve,Se,We,pt;const it=x.isCompressedTexture?x.mipmaps[ue]:x.image;if(G!==null)xe=G.max.x-G.min.x,ce=G.max.y-G.min.y,_e=G.isBox3?G.max.z-G.min.z:1,ye=G.min.x,Ie=G.min.y,Ve=G.isBox3?G.min.z:0;else{const Ze=Math.pow(2,-B);xe=Math.floor(it.width*Ze),ce=Math.floor(it.height*Ze),x.isDataArrayTexture?_e=it.depth:x.isData3DTexture?_e=Math.floor(it.depth*Ze):_e=1,ye=0,Ie=0,Ve=0}U!==null?(Se=U.x,We=U.y,pt=U.z):(Se=0,We=0,pt=0);const nt=se.convert(C.format),Rt=se.convert(C.type);let Me;C.isData3DTexture?(Fe.setTexture3D(C,0),Me=F.TEXTURE_3D):C.isDataArrayTexture||C.isCompressedArrayTexture?(Fe.setTexture2DArray(C,0),Me=F.TEXTURE_2D_ARRAY):(Fe.setTexture2D(C,0),Me=F.TEXTURE_2D),pe.activeTexture(F.TEXTURE0),pe.pixelStorei(F.UNPACK_FLIP_Y_WEBGL,C.flipY),pe.pixelStorei(F.UNPACK_PREMULTIPLY_ALPHA_WEBGL,C.premultiplyAlpha),pe.pixelStorei(F.UNPACK_ALIGNMENT,C.unpackAlignment);const Dt=pe.getParameter(F.UNPACK_ROW_LENGTH),je=pe.getParameter(F.UNPACK_IMAGE_HEIGHT),Bn=pe.getParameter(F.UNPACK_SKIP_PIXELS),Ct=pe.getParameter(F.UNPACK_SKIP_ROWS),Xi=pe.getParameter(F.UNPACK_SKIP_IMAGES);pe.pixelStorei(F.UNPACK_ROW_LENGTH,it.width),pe.pixelStorei(F.UNPACK_IMAGE_HEIGHT,it.height),pe.pixelStorei(F.UNPACK_SKIP_PIXELS,ye),pe.pixelStorei(F.UNPACK_SKIP_ROWS,Ie),pe.pixelStorei(F.UNPACK_SKIP_IMAGES,Ve);const Rn=x.isDataArrayTexture||x.isData3DTexture,kn=C.isDataArrayTexture||C.isData3DTexture;if(x.isDepthTexture){const Ze=Ce.get(x),Tt=Ce.get(C),Qt=Ce.get(Ze.__renderTarget),lt=Ce.get(Tt.__renderTarget);pe.bindFramebuffer(F.READ_FRAMEBUFFER,Qt.__webglFramebuffer),pe.bindFramebuffer(F.DRAW_FRAMEBUFFER,lt.__webglFramebuffer);for(let yt=0;yt<_e;yt++)Rn&&(F.framebufferTextureLayer(F.READ_FRAMEBUFFER,F.COLOR_ATTACHMENT0,Ce.get(x).__webglTexture,B,Ve+yt),F.framebufferTextureLayer(F.DRAW_FRAMEBUFFER,F.COLOR_ATTACHMENT0,Ce.get(C).__webglTexture,ue,pt+yt)),F.blitFramebuffer(ye,Ie,ye+xe,Ie+ce,Se,We,Se+xe,We+ce,F.DEPTH_BUFFER_BIT,F.NEAREST);pe.bindFramebuffer(F.READ_FRAMEBUFFER,null),pe.bindFramebuffer(F.DRAW_FRAMEBUFFER,null)}else if(B!==0||x.isRenderTargetTexture||Ce.has(x)){const Ze=Ce.get(x),Tt=Ce.get(C);pe.bindFramebuffer(F.READ_FRAMEBUFFER,P),pe.bindFramebuffer(F.DRAW_FRAMEBUFFER,W);for(let Qt=0;Qt<_e;Qt++)Rn?F.framebufferTextureLayer(F.READ_FRAMEBUFFER,F.COLOR_ATTACHMENT0,Ze.__webglTexture,B,Ve+Qt):F.framebufferTexture2D(F.READ_FRAMEBUFFER,F.COLOR_ATTACHMENT0,F.TEXTURE_2D,Ze.__webglTexture,B),kn?F.framebufferTextureLayer(F.DRAW_FRAMEBUFFER,F.COLOR_ATTACHMENT0,Tt.__webglTexture,ue,pt+Qt):F.framebufferTexture2D(F.DRAW_FRAMEBUFFER,F.COLOR_ATTACHMENT0,F.TEXTURE_2D,Tt.__webglTexture,ue),B!==0?F.blitFramebuffer(ye,Ie,ye+xe,Ie+ce,Se,We,Se+xe,We+ce,F.COLOR_BUFFER_BIT,F.NEAREST):kn?F.copyTexSubImage3D(Me,ue,Se,We,pt+Qt,ye,Ie,xe,ce):F.copyTexSubImage2D(Me,ue,Se,We,ye,Ie,xe,ce);pe.bindFramebuffer(F.READ_FRAMEBUFFER,null),pe.bindFramebuffer(F.DRAW_FRAMEBUFFER,null)}else kn?x.isDataTexture||x.isData3DTexture?F.texSubImage3D(Me,ue,Se,We,pt,xe,ce,_e,nt,Rt,it.data):C.isCompressedArrayTexture?F.compressedTexSubImage3D(Me,ue,Se,We,pt,xe,ce,_e,nt,it.data):F.texSubImage3D(Me,ue,Se,We,pt,xe,ce,_e,nt,Rt,it):x.isDataTexture?F.texSubImage2D(F.TEXTURE_2D,ue,Se,We,xe,ce,nt,Rt,it.data):x.isCompressedTexture?F.compressedTexSubImage2D(F.TEXTURE_2D,ue,Se,We,it.width,it.height,nt,it.data):F.texSubImage2D(F.TEXTURE_2D,ue,Se,We,xe,ce,nt,Rt,it);pe.pixelStorei(F.UNPACK_ROW_LENGTH,Dt),pe.pixelStorei(F.UNPACK_IMAGE_HEIGHT,je),pe.pixelStorei(F.UNPACK_SKIP_PIXELS,Bn),pe.pixelStorei(F.UNPACK_SKIP_ROWS,Ct),pe.pixelStorei(F.UNPACK_SKIP_IMAGES,Xi),ue===0&&C.generateMipmaps===!0&&C.mipmapsAutoUpdate===!0&&F.generateMipmap(Me),pe.unbindTexture()},this.initRenderTarget=function(x){Ce.get(x).__webglFramebuffer===void 0&&Fe.setupRenderTarget(x)},this.initTexture=function(x){x.isCubeTexture?Fe.setTextureCube(x,0):x.isData3DTexture?Fe.setTexture3D(x,0):x.isDataArrayTexture||x.isCompressedArrayTexture?Fe.setTexture2DArray(x,0):Fe.setTexture2D(x,0),pe.unbindTexture()},this.resetState=function(){Z=0,H=0,te=null,pe.reset(),ae.reset()},typeof __THREE_DEVTOOLS__<"u"&&__THREE_DEVTOOLS__.dispatchEvent(new CustomEvent("observe",{detail:this}))}get coordinateSystem(){return 2e3}get outputColorSpace(){return this._outputColorSpace}set outputColorSpace(e){this._outputColorSpace=e;const t=this.getContext();t.drawingBufferColorSpace=qe._getDrawingBufferColorSpace(e),t.unpackColorSpace=qe._getUnpackColorSpace()}}const Os=["viridis","cividis","earth","grey"],Qo={viridis:"440154 481a6c 472f7d 414487 39568c 31688e 2a788e 23888e 1f988b 22a884 35b779 54c568 7ad151 a5db36 d2e21b fde725",cividis:"00224e 002e6c 1a386f 31446b 434e6c 53596d 61646f 707073 7d7c78 8c8878 9b9476 aba074 bcad6e cdba66 dec958 fee838",earth:"46332a 5e4030 785038 976445 b67a53 d19468 e6b286 f5d3ad",grey:"202020 e8e8e8"},yr="707070 0072b2 e69f00 009e73 f0e442 56b4e9 d55e00 cc79a7 770066 0000cc 44ffee 005500 cc00ff 77cc88 554499 aa0033 aa77ee bbccff 00ff99 dd00bb dd0044 bbaabb 774466 5500ee ff5555 995500 aa4499 99ddcc 551199 99aa88 aadd66 7766dd".split(" "),qn=512;function jo(s){const e=parseInt(s,16);return[e>>16,e>>8&255,e&255]}function $r(s){const e=Qo[s].split(" ").map(jo),t=new Uint8Array(256*4);for(let n=0;n<256;++n){const i=n/255*(e.length-1),r=Math.min(Math.floor(i),e.length-2);for(let a=0;a<3;++a){const o=e[r][a];t[4*n+a]=Math.round(o+(i-r)*(e[r+1][a]-o))}t[4*n+3]=255}return t}function ao(s){const e=new Bi($r(s),256,1,1023);return e.minFilter=e.magFilter=1006,e.needsUpdate=!0,e}function vs(s,e=t=>t){const t=Qo[s].split(" ");return`linear-gradient(to right, ${t.map((i,r)=>`#${i} ${(100*e(r/(t.length-1))).toFixed(1)}%`).join(", ")})`}class ap{texture=new Bi(new Uint8Array(4*qn),qn,1,1023);places=new Map;constructor(){this.texture.minFilter=this.texture.magFilter=1003;for(let e=0;e<qn;++e)this.paint(e)}add(e){for(const t of e)this.places.has(t)||(this.places.set(t,this.freePlace(t)),this.paint(t))}css(e){return`#${this.hex(e)}`}freePlace(e){const t=yr.length;if(e<t)return e;const n=new Set(this.places.values());for(let i=t-1;i>0;--i)if(!n.has(i))return i;return e%t}hex(e){return yr[this.places.get(e)??e%yr.length]}paint(e){this.texture.image.data.set([...jo(this.hex(e)),255],4*(e%qn)),this.texture.needsUpdate=!0}}const cn=new ap,qr=["height","intensity","time","ring","return","class","file","instance","error","packet error"],qs=["p","class","height","plain"];var Rs=(s=>(s[s.picture=0]="picture",s[s.object=1]="object",s[s.part=2]="part",s))(Rs||{});const el=0,Yr=1,tl=2,Bs=1<<el|1<<Yr,op=1<<el|1<<tl;class lp{uniforms;constructor(){this.uniforms={map:{value:ao("earth")},classes:{value:cn.texture},heights:{value:new Ye(0,10)},sliceNormal:{value:new D(0,0,1)},sliceRange:{value:new Ye(-1e30,1e30)},pass:{value:0},object:{value:0},worldMode:{value:0}}}setMap(e){this.uniforms.map.value.dispose(),this.uniforms.map.value=ao(e)}setSlice(e){this.uniforms.sliceNormal.value.set(+(e.axis==="x"),+(e.axis==="y"),+(e.axis==="z"));const n=e.thickness/2,i=this.uniforms.sliceRange.value;e.on?i.set(e.at-n,e.at+n):i.set(-1e30,1e30)}}const cp=`
  uniform sampler2D map;
  uniform sampler2D classes;
  uniform vec2 heights;
  uniform vec3 sliceNormal;
  uniform vec2 sliceRange;
  uniform int pass;
  uniform int object;
  bool sliced(vec3 place) {
    float d = dot(sliceNormal, place);
    return d < sliceRange.x || d > sliceRange.y;
  }
  vec3 mapped(float x) { return texture2D(map, vec2(clamp(x, 0.002, 0.998), 0.5)).rgb; }
  vec3 classColour(float label) {
    return texture2D(classes, vec2((mod(label, ${qn}.0) + 0.5) / ${qn}.0, 0.5)).rgb;
  }
  vec3 heightColour(vec3 place) { return mapped((place.z - heights.x) / max(heights.y - heights.x, 1e-3)); }
  vec4 bytesOf(int n) {
    return vec4(float(n & 255), float((n >> 8) & 255), float((n >> 16) & 255), float((n >> 24) & 255)) / 255.0;
  }
`;function Ii(s,e,t,n){return new pn({uniforms:{...s.uniforms,...e},vertexShader:t,fragmentShader:cp+n,toneMapped:!1})}const zt=s=>document.getElementById(s),$e=document.documentElement;function L(s,e={},...t){const n=document.createElement(s);for(const[i,r]of Object.entries(e))n.setAttribute(i,r);return n.append(...t),n}function Ae(s,e,t){const n=L("button",{type:"button",title:e},s);return n.addEventListener("click",t),n}function dn(s,e,t,n){const i=L("select",{},...e.map(r=>L("option",{value:r},r)));return i.value=t,i.addEventListener("change",()=>n(i.value)),{row:L("label",{class:"row"},s,i),set:r=>i.value=r}}function Kt(s,[e,t,n],i,r){const a=L("input",{type:"range",min:`${e}`,max:`${t}`,step:`${n}`}),o=L("output",{},""),l=()=>o.value=`${Math.round(Number(a.value)*100)/100}`;return a.value=`${i}`,l(),a.addEventListener("input",()=>{l(),r(Number(a.value))}),{row:L("label",{class:"row"},s,a,o),set:c=>{a.value=`${c}`,l()},limits:(c,h)=>{a.min=`${c}`,a.max=`${h}`,a.step=`${(h-c)/1e3}`,l()},step:c=>a.step=`${c}`}}function In(s,e,t){const n=L("input",{type:"checkbox"});return n.checked=e,n.addEventListener("change",()=>t(n.checked)),{row:L("label",{class:"row check"},n,s),set:i=>n.checked=i,on:()=>n.checked}}function ki(s){const e=L("table");for(const[t,n]of s)e.append(L("tr",{},L("th",{scope:"row"},t),L("td",{},n)));return e}function ks(s,e){const t=L("tr",{},...s.map(i=>L("th",{scope:"col"},i))),n=e.map(i=>L("tr",{},...i.map(r=>L("td",{},r))));return L("table",{class:"grid"},L("thead",{},t),L("tbody",{},...n))}function At(s){if(s==null||!Number.isFinite(s))return"–";if(Number.isInteger(s))return`${s}`;const e=Math.abs(s);return e>=1e4?s.toFixed(1):e>=.001?`${Number(s.toPrecision(4))}`:s.toExponential(2)}const hp=[["drag","turn about the target"],["shift + drag, right button","move along"],["wheel, pinch, + and -","nearer and farther"],["arrows","turn"],["W A S D, Q E","fly ahead, left, back, right, down, up"],["click, Enter","pick what is under the cursor, or in the middle of the view"]];function dp(s){const e=s.target;return s.ctrlKey||s.metaKey||e instanceof HTMLSelectElement?!0:e instanceof HTMLInputElement?["checkbox","radio","range"].includes(e.type)?/^(Arrow|Home|End|Page| $)/.test(s.key):!0:!1}function nl(s){return(s.ctrlKey||s.metaKey)&&s.key==="Z"?"y":s.key}function Ir(s){const e=s.target instanceof HTMLInputElement&&!["checkbox","radio","range"].includes(s.target.type);return(s.ctrlKey||s.metaKey)&&["z","Z","y"].includes(s.key)&&!e}function up(s){return s.filter(e=>e.tool).map(e=>Ae(e.tool,`${e.name} (${e.key==="Escape"?e.key:e.key.toUpperCase()})`,e.act))}function fp(s,e,t){const n=t.map(i=>[i.key===" "?"space":i.key.toUpperCase(),i.name]);s.replaceChildren(L("div",{class:"head"},L("h2",{},"Keys"),Ae("×","Close (Escape)",()=>s.close())),ki([...hp,...n]),L("p",{},e))}function pp(s,e){return s[(s.indexOf(e)+1)%s.length]}function Kr(s){$e.dataset.panel=s?"open":"closed",zt("menu").setAttribute("aria-expanded",`${s}`)}async function mp(s){const e=L("a",{download:"underbrush.png",href:URL.createObjectURL(await s.viewer.picture())});e.click(),URL.revokeObjectURL(e.href)}async function gp(s,e){e.keepLink(),await new Promise(t=>setTimeout(t,350)),await navigator.clipboard.writeText(location.href),s.tell("The link is copied")}function _p(s,e,t){const{state:n,viewer:i}=s,r=zt("help"),a=(h,u,d)=>()=>i.lookFrom(new D(h,u,d)),o=(h,u,d)=>()=>{n[h]=pp(u,n[h]),d.set(n[h]),s.apply()},l=()=>{n.slice.on=!n.slice.on,n.slice.on&&n.slice.at===0&&(n.slice.at=i.navigation.target[n.slice.axis]),e.sliceOn.set(n.slice.on),e.sliceAt.set(n.slice.at),s.apply()},c=()=>{n.theme=$e.dataset.theme==="dark"?"light":"dark",s.apply()};return[{key:"m",name:"show or hide the menu",act:()=>Kr($e.dataset.panel==="closed")},{key:"f",name:"look at everything",tool:"All",act:()=>s.frame()},{key:"1",name:"look from above",tool:"Top",act:a(0,-.01,1)},{key:"2",name:"look from the south",act:a(0,-1,0)},{key:"3",name:"look from the east",act:a(1,0,0)},{key:"c",name:"colour points by the next quantity",act:o("points",qr,e.pointMode)},{key:"v",name:"colour elements by the next quantity",act:o("worlds",qs,e.worldMode)},{key:"x",name:"slice on or off",tool:"Slice",act:l},{key:"n",name:"measure between two places",tool:"Measure",act:()=>t.toggleMeasure()},{key:"b",name:"why did the picked beam end here, in the first model or scene",act:()=>t.followPicked()},{key:";",name:"waveform and echoes of the picked beam, in the first model or scene",act:()=>t.receivePicked()},{key:"p",name:"save a picture",tool:"Picture",act:()=>s.run(mp(s))},{key:"l",name:"copy a link to this view",tool:"Link",act:()=>s.run(gp(s,e))},{key:"t",name:"dark or light",tool:"Theme",act:c},{key:"?",name:"this help",tool:"?",act:()=>r.open?r.close():r.showModal()},{key:"Escape",name:"close the details, put the tool down",act:()=>s.closeDetails()}]}function vp(s,e,t){const{viewer:n}=s;zt("tools").append(...up(t)),zt("menu").addEventListener("click",()=>Kr($e.dataset.panel==="closed")),fp(zt("help"),s.list.program,t);const i=()=>n.pick(...n.middle),r={ArrowLeft:()=>n.navigation.orbit(-.1,0),ArrowRight:()=>n.navigation.orbit(.1,0),ArrowUp:()=>n.navigation.orbit(0,.1),ArrowDown:()=>n.navigation.orbit(0,-.1),"+":()=>n.navigation.zoom(.8),"-":()=>n.navigation.zoom(1.25),Enter:()=>{e.pick(i())}};window.addEventListener("keydown",a=>{if(dp(a)&&!Ir(a))return;const o=t.find(c=>c.key===nl(a)),l=r[a.key];if(n.navigation.used=!0,l&&(a.key!=="Enter"||a.target===n.canvas))l();else if(o)o.act();else if(n.navigation.keyDown(a.key.toLowerCase()))n.draw();else return;(a.target===n.canvas||Ir(a))&&a.preventDefault()}),window.addEventListener("keyup",a=>n.navigation.keyUp(a.key.toLowerCase()))}class il extends Error{constructor(e){super("the labels were changed in another window"),this.revision=e}revision}async function Ys(s,e={},t="GET"){const n=await fetch(`./api/${s}`,{headers:e,method:t});if(n.ok)return n;if(n.status===409)throw new il((await n.json()).revision);let i=`${n.status}`;try{i=(await n.json()).error}catch{}throw new Error(i)}async function ut(s){return await(await Ys(s)).json()}async function bn(s){return(await Ys(s)).arrayBuffer()}async function sl(s,e,t){const n=`bytes=${e}-${e+t-1}`;return(await Ys(`octree/data?file=${s}`,{Range:n})).arrayBuffer()}const rl=7500;function un(s){return Object.entries(s).filter(([,t])=>t!=null&&t!==""&&t!==!1).filter(([,t])=>!Array.isArray(t)||t.length>0).map(([t,n])=>`${t}=${encodeURIComponent(n===!0?"1":String(n)).replaceAll("%2C",",")}`).join("&")}async function En(s,e){return await(await Ys(`${s}?${un(e)}`,{},"POST")).json()}function al(s,e){return Math.max(1,e/(s?.mode==="split"?2:1))}function xp(s,e){if(!s)return[{side:null,from:0,width:e}];const{mode:t,left:n,right:i,share:r}=s,a=Math.round(e*(t==="split"?.5:r));return[{side:n,from:0,width:a},{side:i,from:a,width:e-a}].filter(l=>l.width>0)}function Cs(s,e,t){if(!s)return{x:t,side:null};const n=e*(s.mode==="split"?.5:s.share);return{x:s.mode==="split"&&t>=n?t-n:t,side:t<n?s.left:s.right}}function br(s,e,t,n){if(!e)return n();const i=s.map(a=>a.visible);s.forEach(a=>a.visible=a.visible&&(a===e||t.includes(a)));const r=n();return s.forEach((a,o)=>a.visible=i[o]),r}const Sp=40,oo=["all of its path","its path for 1 s","its path for 3 s"],Mp={"all of its path":null,"its path for 1 s":1,"its path for 3 s":3};function wp(s){try{return JSON.stringify(JSON.parse(s))}catch{return s||"null"}}function Ui(s){const[,e,t,n,i,r,a,o]=s;return{at:new D(e,t,n),turn:new Un(r,a,o,i)}}function yp({poses:s},e){const t=s.findIndex(l=>l[0]>e);if(t<=0)return Ui(t<0?s.at(-1):s[0]);const[n,i]=[s[t-1],s[t]],r=(e-n[0])/(i[0]-n[0]),[a,o]=[Ui(n),Ui(i)];return{at:a.at.lerp(o.at,r),turn:a.turn.slerp(o.turn,r)}}function Er(s){const e=s.parts.flatMap(i=>i.poses),t=Math.max(Math.min(...s.parts.map(i=>i.from_s??-1/0)),Math.min(...e.map(i=>i[0]))),n=Math.min(Math.max(...s.parts.map(i=>i.to_s??1/0)),Math.max(...e.map(i=>i[0])));return[t,n]}class bp{constructor(e,t,n,i){this.app=e,this.menu=t,this.jobs=n,this.simulate=i,this.list.addEventListener("change",()=>this.choose(this.list.value)),this.dragBox=In("Drag actors in the view",!1,()=>this.show());const r=dn("A drag moves",oo,this.within,c=>this.within=c),a=(c,h,u)=>Ae(c,h,u);this.section=e.section("Actors",this.list,this.facts,L("div",{class:"buttons"},a("Remove","Take the actor away",()=>this.add({edit:"remove",actor:this.chosen})),a("Turn round","Turn the actor by half a turn where it is",()=>this.add({edit:"move",actor:this.chosen,yaw_rad:Math.PI})),a("Copy","Add the same actor once more",()=>this.copy()),a("Delay","Let the actor do everything so many seconds later",()=>this.add({edit:"delay",actor:this.chosen,by_s:Number(this.seconds.value)})),a("Undo","Take the last edit of an actor back (,)",()=>this.undo()),a("Redo","Apply it again (.)",()=>this.redo())),L("label",{class:"row number"},"Delay, s",this.seconds),this.dragBox.row,r.row,this.told);const o=L("input",{type:"file",accept:".json",hidden:"","aria-label":"File of edits"});o.addEventListener("change",()=>{o.files?.[0]&&e.run(this.openList(o.files[0])),o.value=""}),this.section.append(o,L("div",{class:"buttons"},Ae("Open edits","Open a file of edits; it can be dropped on the page, too",()=>o.click()))),window.addEventListener("dragover",c=>c.preventDefault()),window.addEventListener("drop",c=>{c.preventDefault();const h=c.dataTransfer?.files[0];h&&e.run(this.openList(h))}),n&&this.section.append(L("div",{class:"buttons"},Ae("Write edits","Write the edits to the folder for labels, for simulate --actors",()=>e.run(this.write())),Ae("Replay","Simulate the beams of the chosen log in the chosen world with these actors",()=>e.run(this.replay())))),e.viewer.overlays.add(this.paths),t.time.onTime.push(()=>this.place()),t.movingTimes=()=>this.times(),e.onApply.push(()=>e.run(this.open()));const{canvas:l}=e.viewer;l.addEventListener("pointerdown",c=>this.down(c),{capture:!0}),l.addEventListener("pointermove",c=>this.move(c),{capture:!0}),l.addEventListener("pointerup",c=>this.up(c),{capture:!0}),this.show()}app;menu;jobs;simulate;world=null;editable=!1;actors=[];edits={actors:"",edits:[]};filed="[]";undone=[];chosen="";list=L("select",{"aria-label":"Actors",size:"5"});seconds=L("input",{type:"number",value:"0.5",step:"0.1","aria-label":"Delay, s"});facts=L("div",{"aria-label":"Facts of the actor",role:"group"});told=L("p",{class:"note","aria-label":"Edits"});paths=new Ot;dragBox;within=oo[0];drag=null;section;queue=Promise.resolve();async open(){const e=[...this.app.viewer.worlds].find(i=>i.group.visible&&i.moves)??null;if(e===this.world)return;this.world=e,[this.edits,this.undone,this.actors,this.filed]=[{actors:"",edits:[]},[],[],"[]"];const{edits:t}=this.app.state,n=t&&t.file===e?.file.id?JSON.stringify(t.list):"";if(e&&await this.fetch(n).catch(i=>(this.app.fail(i),this.fetch(""))),e){for(const i of this.actors.flatMap(r=>r.parts.flatMap(a=>a.poses)))e.bounds.expandByPoint(Ui(i).at.add(e.group.position));this.app.viewer.navigation.framed&&this.app.frame()}this.menu.limits(),this.show()}async fetch(e,t=""){const n=this.world;if(encodeURIComponent(e).length>rl)throw new Error(`${t||"edits"}: more edits than a request has room for`);const i=await ut(`actors?${un({file:n.file.id,edits:e,name:t})}`);if(n!==this.world)return;({actors:this.actors,editable:this.editable,list:this.edits}=i);const r=this.app.list.edits?.file===n.file.id;this.app.state.edits=r||this.edits.edits.length>0?{file:n.file.id,list:this.edits}:null}text(){return JSON.stringify(this.edits.edits)}async openList(e){if(await this.queue,!this.world||!this.editable)throw new Error("Show a folder of actors, in which all moves, first");![this.filed,"[]"].includes(this.text())&&!confirm("The edits so far were not written. Open others in their place?")||(await this.fetch(wp(await e.text()),e.name),this.undone=[],this.filed=this.text(),this.show(),this.app.tell(`Opened: ${e.name}, edits of ${this.edits.actors}`))}change(e){const t=this.queue.then(async()=>{const n=e();n&&this.world&&await this.fetch(JSON.stringify({...this.edits,edits:n}))});this.queue=t.catch(()=>{}),this.app.run(t.finally(()=>this.show()))}add(e){if(!this.editable)return this.app.tell("Only a folder of actors, in which all moves, can be edited");if(this.chosen==="")return this.app.tell("Choose an actor first");this.change(()=>(this.undone=[],[...this.edits.edits,e]))}copy(){const e=new Set(this.actors.map(i=>i.name));let t=2;for(;e.has(`${this.chosen}-copy-${t}`);)++t;const n=`${this.chosen}-copy-${t}`;this.add({edit:"copy",actor:this.chosen,as:n}),this.queue.then(()=>this.choose(n))}undo(){this.change(()=>{const e=this.edits.edits.at(-1);return e&&this.undone.push(e),e?this.edits.edits.slice(0,-1):null})}redo(){this.change(()=>{const e=this.undone.pop();return e?[...this.edits.edits,e]:null})}async write(){if(!this.world)throw new Error("Show a folder of actors first");await this.queue;const e=this.jobs.freshName("edits",".json"),t=await En("actors/write",{file:this.world.file.id,name:e,edits:JSON.stringify(this.edits)});return this.filed=this.text(),this.app.tell(`Written: ${t.path}`),e}async replay(){this.simulate&&await this.simulate(await this.write())}choose(e){this.chosen=e,this.show()}times(){if(this.actors.length===0)return null;const e=this.actors.map(Er);return[Math.min(...e.map(t=>t[0])),Math.max(...e.map(t=>t[1]))]}shownTimes(){const[e,t]=this.menu.time.shown();return[this.menu.time.first+e,this.menu.time.first+t]}now(e){const[t,n]=this.shownTimes();return e.parts.filter(r=>(r.from_s??-1/0)<=n&&(r.to_s??1/0)>t).at(-1)??null}placeOf(e){const t=this.now(e);if(!t)return null;const n=Math.min(this.shownTimes()[1],t.to_s??1/0),i=yp(t,n);return this.drag?.name===e.name&&i.at.add(this.drag.by),{...i,instance:t.instance}}place(){if(!this.world)return;const e=this.actors.map(i=>({actor:i,place:this.placeOf(i)}));this.world.moveTo(e.flatMap(({place:i})=>i?[i]:[]));const t=new D(...this.world.facts.origin_m),n=i=>[...i.clone().add(t).toArray(),...this.pixelOf(i)].map(r=>r.toFixed(3)).join(" ");$e.dataset.actorsAt=e.map(({actor:i,place:r})=>`${i.name} ${r?n(r.at):"absent"}`).join("; "),this.app.viewer.draw()}show(){this.section.hidden=!this.world,this.actors.some(i=>i.name===this.chosen)||(this.chosen=this.actors[0]?.name??"");const e=i=>(Er(i)[1]-Er(i)[0]).toFixed(1);this.list.replaceChildren(...this.actors.map(i=>L("option",{value:i.name},`${i.name}: ${i.class}, ${e(i)} s`))),this.list.value=this.chosen;const t=this.actors.find(i=>i.name===this.chosen),n=i=>i===null?"unknown":`${i}`;if(this.facts.replaceChildren(...t?[ki([["returns",n(t.returns)],["scans",n(t.scans)],["there for, s",e(t)]])]:[]),this.told.textContent=`${this.edits.edits.length} edits${this.undone.length>0?`, ${this.undone.length} taken back`:""}`,$e.dataset.actors=`${this.actors.length}`,$e.dataset.edits=`${this.edits.edits.length}`,this.paths.clear(),this.paths.visible=this.world!==null,this.world){this.paths.position.copy(this.world.group.position);for(const i of this.actors)this.paths.add(this.pathOf(i));this.place()}this.app.viewer.draw()}pathOf(e){const n=e.parts.flatMap(a=>a.poses).sort((a,o)=>a[0]-o[0]).map(a=>Ui(a).at),i=new Si({color:e.name===this.chosen?15787074:5682409,depthTest:!1}),r=new Hs(new ht().setFromPoints(n),i);return r.frustumCulled=!1,r.renderOrder=9,r}pixelOf(e){const{camera:t,canvas:n,sides:i}=this.app.viewer,r=e.clone().add(this.world.group.position).project(t);return r.z>=1?[1/0,1/0]:[(r.x+1)/2*al(i,n.clientWidth),(1-r.y)/2*n.clientHeight]}near(e,t){const{canvas:n,sides:i}=this.app.viewer,r=Cs(i,n.clientWidth,e).x;let a=null,o=Sp;for(const l of this.actors){const c=this.placeOf(l);if(!c)continue;const[h,u]=this.pixelOf(c.at),d=Math.hypot(h-r,u-t);d<o&&([a,o]=[{name:l.name,height:c.at.z+this.world.group.position.z},d])}return a}down(e){if(!this.dragBox.on()||!this.world||!this.editable||e.button!==0)return;const t=this.near(e.offsetX,e.offsetY),n=t&&this.app.viewer.placeUnder(e.offsetX,e.offsetY,t.height);!t||!n||(e.stopImmediatePropagation(),this.app.viewer.canvas.setPointerCapture(e.pointerId),this.choose(t.name),this.drag={name:t.name,pointer:e.pointerId,from:n,by:new D})}move(e){if(!this.drag||e.pointerId!==this.drag.pointer)return;e.stopImmediatePropagation();const t=this.app.viewer.placeUnder(e.offsetX,e.offsetY,this.drag.from.z);t&&(this.drag.by=t.sub(this.drag.from)),this.place()}up(e){if(!this.drag||e.pointerId!==this.drag.pointer)return;e.stopImmediatePropagation();const{name:t,by:n}=this.drag;this.drag=null;const i=n.toArray().map(o=>Math.round(o*1e3)/1e3);if(Math.hypot(...i)<.01)return this.place();const r=Mp[this.within],a=Math.round(this.shownTimes()[1]*1e6)/1e6;this.add({edit:"shift",actor:t,translation_m:i,...r===null?{}:{at_s:a,within_s:r}})}actions(){return[{key:",",name:"actors: undo",act:()=>this.undo()},{key:".",name:"actors: redo",act:()=>this.redo()}]}}const xs=["off","split","swipe"];class Ep{constructor(e,t,n){this.app=e,this.show=t,this.shown=n,this.modeBox=dn("Compare",xs,"off",a=>this.set(a));const i=Kt("Line",[0,1,.01],.5,a=>{this.share=a,e.run(this.apply())}),r=Ae("Errors","Colour both logs by the error of the range, beam by beam",()=>e.run(this.errors()));e.section("Side by side",this.modeBox.row,...this.boxes.map(a=>a.row),i.row,r),e.viewer.canvas.after(this.over),this.refresh()}app;show;shown;mode="off";share=.5;boxes=["Left","Right"].map(e=>{const t=L("select",{"aria-label":e});return t.addEventListener("change",()=>this.app.run(this.apply())),{box:t,row:L("label",{class:"row"},e,t)}});modeBox;names=["left","right"].map(e=>L("p",{class:`side ${e}`}));over=L("div",{id:"sides",hidden:""},...this.names,L("div",{class:"line"}));refresh(){const e=this.app.files.list.filter(t=>t.kind!=="score");this.boxes.forEach(({box:t},n)=>{const i=t.value;t.replaceChildren(...e.map(r=>L("option",{value:`${r.id}`},r.name))),t.value=i||`${e[Math.min(n,e.length-1)]?.id??""}`})}set(e){this.mode=e,this.modeBox.set(e),this.app.run(this.apply())}async errors(){const e=this.boxes.map(({box:r})=>Number(r.value));for(const r of e)await this.show(r);const[t,n]=e.map(r=>this.app.files.clouds.get(r));if(!t||!n)throw new Error("Errors need two logs, left and right");await Promise.all([t.compareWith(n.octree.file),n.compareWith(t.octree.file)]);const i=this.app.state.points==="packet error"?"packet error":"error";this.app.state.points=i,this.shown(i),this.app.apply(),this.app.tell("Errors from 0 (dark) to 1 m and more (bright); orange where the other log has no hit")}async apply(){const{viewer:e,files:t}=this.app,[n,i]=this.boxes.map(({box:r})=>Number(r.value));if(this.mode==="off"||this.boxes.some(({box:r})=>r.value===""))e.sides=null;else{await this.show(n),await this.show(i);const r=a=>(t.clouds.get(a)??t.worlds.get(a)).group;e.sides={mode:this.mode,left:r(n),right:r(i),share:this.share}}$e.dataset.compare=this.mode,this.over.hidden=e.sides===null,this.over.style.setProperty("--at",`${100*(this.mode==="split"?.5:this.share)}%`),[n,i].forEach((r,a)=>this.names[a].textContent=e.sides?t.file(r).name:""),e.resize(),e.navigation.framed&&this.app.frame()}actions(){return[{key:"0",name:"side by side: off, split screen, swipe",act:()=>this.set(xs[(xs.indexOf(this.mode)+1)%xs.length])}]}}class Tp{constructor(e,t,n,i,r){this.list=e,this.state=t,this.viewer=n,this.files=i,this.shown=r}list;state;viewer;files;shown;status=zt("status");details=zt("details");panel=zt("panel");onApply=[];onClose=[];tell(e){this.status.textContent=e}fail(e){this.tell(e instanceof Error?e.message:String(e)),$e.dataset.error=this.status.textContent??""}run(e){e.catch(t=>this.fail(t))}apply(){this.onApply.forEach(e=>e())}frame(){this.viewer.frameAll(),this.apply()}showDetails(e){this.details.replaceChildren(...e),this.details.hidden=!1,this.details.scrollTop=0}closeDetails(){this.details.hidden=!0,this.onClose.forEach(e=>e()),this.viewer.mark(),this.viewer.canvas.focus()}section(e,...t){const n=L("section",{},L("h2",{},e),...t);return this.panel.append(n),n}of(e){return this.files.list.filter(t=>t.kind===e)}}function Ps(s,e,t,n){const i=new Float32Array(n*e.count);for(let r=0;r<e.count;++r){const a=e.start+r*e.bytes+t;for(let o=0;o<n;++o)i[n*r+o]=s.getFloat32(a+4*o,!0)}return i}function Ur(s,e,t){const n=new Uint32Array(e.count);for(let i=0;i<e.count;++i)n[i]=s.getUint32(e.start+i*e.bytes+t,!0);return n}function lo(s){const e=new Uint32Array(2*s.length);return s.forEach((t,n)=>e.fill(t,2*n,2*n+2)),e}function ol(s){const e=Float32Array.from(s).sort(),t=n=>e[Math.floor(n*(e.length-1))];return[t(.02),t(.98)]}function Gi(s){const e=new vt,t=s.length/3;if(t===0)return e;const n=Math.ceil(t/2e4);for(let i=0;i<3;++i){const[r,a]=ol(Float32Array.from({length:Math.ceil(t/n)},(o,l)=>s[3*l*n+i]));e.min.setComponent(i,r),e.max.setComponent(i,a)}return e}const Ap=32,Rp=`
  attribute vec4 rowBytes;
  attribute float kind;
  varying vec3 place;
  varying vec4 part;
  varying float outcome;
  void main() {
    vec4 world = modelMatrix * vec4(position, 1.0);
    place = world.xyz;
    part = rowBytes;
    outcome = kind;
    gl_Position = projectionMatrix * viewMatrix * world;
  }
`,Cp=`
  varying vec3 place;
  varying vec4 part;
  varying float outcome;
  void main() {
    if (sliced(place)) discard;
    vec3 colour = outcome > 1.5 ? vec3(0.95, 0.81, 0.5) : outcome > 0.5 ? vec3(0.34, 0.71, 0.91) : vec3(0.9, 0.62, 0.0);
    gl_FragColor = pass == 0 ? vec4(colour, 1.0) : pass == 1 ? bytesOf(object) : part;
  }
`;async function Pp(s,e,t,n,i){const r=new DataView(await bn(`beams?file=${s}&run=${e}`)),a=r.getUint32(0,!0),o=r.getUint32(4,!0),l={start:8,bytes:Ap,count:a},c=Ps(r,l,0,6),h=lo(Ur(r,l,24)),u=Float32Array.from(lo(Ur(r,l,28))),d=new ht;d.setAttribute("position",new ct(c,3)),d.setAttribute("rowBytes",new ct(new Uint8Array(h.buffer),4,!0)),d.setAttribute("kind",new ct(u,1));const f=Ii(t,{object:{value:i}},Rp,Cp),g=new Vs(d,f);return g.position.copy(n),g.frustumCulled=!1,{lines:g,beams:a,step:o}}function Tr(s,e,t,n=[]){const i=new Ot,r=new D(...s.origin_m).sub(t),a=new D(...s.direction),o=new D(...s.end_m).sub(t),l=new ht().setFromPoints([r,o]);i.add(new Vs(l,new Si({color:13983232})));const c=(u,d,f)=>{const g=new ht().setFromPoints(u),S=new Wr({color:d,size:f,sizeAttenuation:!1,depthTest:!1});i.add(new Hi(g,S))};s.hit&&c([o],13983232,10);const h=u=>r.clone().addScaledVector(a,u);return n.length>0&&c(n.map(h),15787074,10),e&&(c(e.met.filter(u=>!u.accepts).map(u=>h(u.range_m)),5682409,7),c(e.met.filter(u=>u.accepts).map(u=>h(u.range_m)),13400487,7),e.simulated_range_m!==null&&c([h(e.simulated_range_m)],15787074,10)),i.traverse(u=>u.renderOrder=10),i}function Lp(s){s.traverse(e=>{(e instanceof Vs||e instanceof Hi)&&(e.geometry.dispose(),e.material.dispose())})}const ui=24,Fi=32,Dp=29,co=8<<20,Np=50,Fp=32;async function ho(s,e,t){const n=new Uint8Array(t);for(let i=0;i<t;i+=co){const r=Math.min(co,t-i);n.set(new Uint8Array(await sl(s,e+i,r)),i)}return new DataView(n.buffer)}function Ip(s,e,t){const n=new D(...t.root_low_m),i=new D(t.root_side_m,t.root_side_m,t.root_side_m),r=[];for(let a=0;a<e;++a)r.push({index:a,at:Number(s.getBigUint64(a*ui,!0)),points:s.getUint32(a*ui+8,!0),level:s.getUint8(a*ui+17),children:[],box:new vt(n.clone(),n.clone().add(i))});for(let a=0;a<e;++a){const o=r[a];let l=s.getUint32(a*ui+12,!0);const c=s.getUint8(a*ui+16),h=o.box.max.clone().sub(o.box.min).multiplyScalar(.5);for(let u=0;u<8;++u){if(!(c>>u&1))continue;const d=r[l++],f=new D(u&1,u>>1&1,u>>2);d.box.min.copy(o.box.min).add(f.multiply(h)),d.box.max.copy(d.box.min).add(h),o.children.push(d)}}return r[0]}function Up(s,e){const t=[];for(let n=0;n<e;++n)t.push({firstRow:Number(s.getBigUint64(n*Fi,!0)),rows:s.getUint32(n*Fi+16,!0),scan:s.getUint32(n*Fi+20,!0),time:s.getFloat64(n*Fi+24,!0)});return t}async function Op(s,e,t){const{state:n}=await ut(`octree?file=${s}&build=0`),i=n==="ready"||t();n==="absent"&&await i;for(let r=Np;;r=Math.min(r*1.5,1e3)){const a=await ut(`octree?file=${s}`);if(a.state!=="absent"){if(a.state==="failed")throw new Error(a.error);if(a.state==="ready"){const o=await ho(s,a.nodes_at,a.nodes*ui),l=await ho(s,a.runs_at,a.runs*Fi);return{file:s,facts:a.octree,root:Ip(o,a.nodes,a.octree),nodes:a.nodes,runs:Up(l,a.runs)}}e(a.done),await new Promise(o=>setTimeout(o,r))}}}async function ll(s,e){const t=e.points,n=e.data??(t>0?await sl(s,e.at,t*Dp):new ArrayBuffer(0));return{count:t,position:new Float32Array(n,0,3*t),intensity:new Float32Array(n,12*t,t),time:new Float32Array(n,16*t,t),row:new Uint32Array(n,20*t,t),rowBytes:new Uint8Array(n,20*t,4*t),ring:new Uint16Array(n,24*t,t),label:new Uint16Array(n,26*t,t),echo:new Uint8Array(n,28*t,t)}}async function Bp(s){const e=await bn(`preview?file=${s}`).catch(()=>null);if(!e)return null;const t=new Uint32Array(e,0,1)[0];if(t===0)return null;const n=[...new Float64Array(e,8,3)],i={index:0,at:0,points:t,level:0,children:[],box:new vt,data:e.slice(Fp)},{position:r,intensity:a,time:o,ring:l,echo:c}=await ll(s,i),h=g=>Array.prototype.reduce.call(g,(S,m)=>Math.max(S,m),0),u=Gi(r);i.box.setFromArray(r);const d=i.box.min.toArray();r.forEach((g,S)=>r[S]=g-d[S%3]);const f={rows:0,beams:0,points:t,origin_m:n,root_low_m:[0,0,0],root_side_m:0,low_m:u.min.toArray(),high_m:u.max.toArray(),first_time_s:0,last_time_s:h(o),intensity:[0,h(a)],most_ring:h(l),most_echo:h(c),labels:[]};return{file:s,facts:f,root:i,nodes:1,runs:[]}}const kp=1e8,Gp=4278214358,uo=s=>new Uint32Array(s.buffer,s.byteOffset,s.length/4);function zp(s){const e=(t,n)=>Math.round(.2*(s>>t&255)+.8*n)<<t;return(4278190080|e(0,255)|e(8,89)|e(16,191))>>>0}function Hp(s,e,t){const n=(h,u,d)=>{const f=1/Math.max(d-u,1e-6);return g=>(h[g]-u)*f},{position:i,intensity:r,time:a,ring:o}=s;if(t.mode==="height"){const[h,u]=t.heights,d=1/Math.max(u-h,.001);return f=>(i[3*f+2]-h)*d}if(t.mode==="intensity")return n(r,...t.intensities);if(t.mode==="time")return n(a,0,t.span);if(t.mode==="ring")return n(o,0,Math.max(t.rings,1));if(t.mode!=="error"&&t.mode!=="packet error")return null;const{errors:l}=e,c=t.mode==="error"?0:1;return h=>l?Math.sqrt(Math.min(1,Math.abs(l[2*h+c]))):0}function Vp(s,{marks:e},t){if(t.mode==="return")return n=>s.echo[n];if(t.mode==="file")return()=>t.file+1;if(t.mode==="instance"){if(!e)return()=>0;const n=i=>e[4*i+1]+256*e[4*i+2]+65536*e[4*i+3];return i=>n(i)===0?0:1+n(i)*5%14}return e?n=>e[4*n]%128:n=>s.label[n]}function Wp(s,e,t,n){const i=Hp(s,e,t);if(i){const a=uo($r(t.map));for(let c=0;c<s.count;++c)n[c]=a[Math.min(255,Math.max(0,Math.round(255*i(c))))];const{errors:o}=e,l=t.mode==="error"?0:t.mode==="packet error"?1:-1;if(o&&l>=0)for(let c=0;c<s.count;++c)Math.abs(o[2*c+l])>kp&&(n[c]=Gp)}else{const a=Vp(s,e,t),o=uo(cn.texture.image.data);for(let l=0;l<s.count;++l)n[l]=o[a(l)%qn]}const{marks:r}=e;if(r)for(let a=0;a<s.count;++a)t.hidden.has(r[4*a]%128)?n[a]=0:r[4*a]>=128&&(n[a]=zp(n[a]))}const cl=60,hl=.2,dl=2.5;class Xp{width=0;height=0;colour=new Uint32Array(0);near=new Float32Array(0);matrix=new Qe;begin(e,t,n){(e!==this.width||t!==this.height)&&([this.width,this.height]=[e,t],this.colour=new Uint32Array(e*t),this.near=new Float32Array(e*t)),this.colour.fill(n),this.near.fill(0)}draw(e,t,n,i,r){const{position:a,colours:o,count:l}=e,c=r.times||r.slice?this.filtered(e,r):null,h=this.matrix.makeTranslation(e.offset).premultiply(t).elements,{colour:u,near:d,width:f,height:g}=this,[S,m]=[n.width/2,g/2],[p,M,A,b]=[h[0],h[4],h[8],h[12]],[R,E,_,y]=[h[1],h[5],h[9],h[13]],[k,N,I,z]=[h[3],h[7],h[11],h[15]],$=h[2],P=h[6],W=h[10],Z=h[14],[H,te]=[Math.max(0,n.from),Math.min(f,n.to)],V=$p(i),j=n.left+S-i/2+.5,ee=m-i/2+.5,we=i===2;for(let Pe=0,q=0;Pe<l;++Pe,q+=3){const he=o[Pe];if(he===0||c&&c[Pe]===0)continue;const ve=a[q],Ee=a[q+1],fe=a[q+2],De=k*ve+N*Ee+I*fe+z;if(De<=0||$*ve+P*Ee+W*fe+Z<-De)continue;const Ke=1/De,Te=Math.floor(j+S*Ke*(p*ve+M*Ee+A*fe+b)),He=Math.floor(ee+m*Ke*(R*ve+E*Ee+_*fe+y));if(we&&Te>=H&&Te<te-1&&He>=0&&He<g-1){const Ne=He*f+Te;Ke>d[Ne]&&(d[Ne]=Ke,u[Ne]=he),Ke>d[Ne+1]&&(d[Ne+1]=Ke,u[Ne+1]=he),Ke>d[Ne+f]&&(d[Ne+f]=Ke,u[Ne+f]=he),Ke>d[Ne+f+1]&&(d[Ne+f+1]=Ke,u[Ne+f+1]=he);continue}if(!(Te<H-i||Te>=te||He<-i||He>=g))for(let Ne=0;Ne<V.length;Ne+=2){const Be=Te+V[Ne],dt=He+V[Ne+1];if(Be<H||Be>=te||dt<0||dt>=g)continue;const at=dt*f+Be;Ke>d[at]&&(d[at]=Ke,u[at]=he)}}}filtered({count:e,position:t,offset:n,time:i},{times:r,slice:a}){const o=new Uint8Array(e).fill(1);if(r)for(let h=0;h<e;++h)(i[h]<r[0]||i[h]>r[1])&&(o[h]=0);if(!a)return o;const[l,c]=[a.low-n.getComponent(a.axis),a.high-n.getComponent(a.axis)];for(let h=0,u=a.axis;h<e;++h,u+=3)(t[u]<l||t[u]>c)&&(o[h]=0);return o}shade(e){const{colour:t,near:n,width:i,height:r}=this,a=e*i;for(let o=e;o<r-e;++o)for(let l=o*i+e,c=(o+1)*i-e;l<c;++l){const h=n[l];if(h===0)continue;const u=(n[l-e]||h)+(n[l+e]||h)-2*h,d=(n[l-a]||h)+(n[l+a]||h)-2*h,f=(u>0?u:0)+(d>0?d:0);if(f<.001*h)continue;const g=Math.max(hl,h/(h+.5*cl*f)),S=t[l];t[l]=((S&255)*g|(S>>8&255)*g<<8|(S>>16&255)*g<<16|4278190080)>>>0}}}const fo=new Map;function $p(s){const e=fo.get(s);if(e)return e;const t=[],n=s<=dl,i=n?Math.max(1,Math.round(s)):Math.ceil(s);for(let a=0;a<i;++a)for(let o=0;o<i;++o){const[l,c]=[(o+.5)/s-.5,(a+.5)/s-.5];(n||l*l+c*c<=.25)&&t.push(o,a)}const r=Int32Array.from(t);return fo.set(s,r),r}const qp=8,Yp=64,Kp=`
  attribute vec4 colour;
  attribute float time;
  attribute vec4 rowBytes;
  uniform float size;
  uniform vec2 range;
  varying vec3 place;
  varying vec4 part;
  varying vec4 shown;
  void main() {
    vec4 world = modelMatrix * vec4(position, 1.0);
    place = world.xyz;
    part = rowBytes;
    shown = colour;
    gl_Position = projectionMatrix * viewMatrix * world;
    if (time < range.x || time > range.y || colour.a < 0.5) gl_Position = vec4(2.0, 2.0, 2.0, 1.0);
    gl_PointSize = size;
  }
`,Zp=`
  uniform float size;
  varying vec3 place;
  varying vec4 part;
  varying vec4 shown;
  void main() {
    if (sliced(place)) discard;
    vec2 off = gl_PointCoord - 0.5;
    if (size > ${dl} && dot(off, off) > 0.25) discard;
    gl_FragColor = pass == 0 ? vec4(shown.rgb, 1.0) : pass == 1 ? bytesOf(object) : part;
  }
`;class po{constructor(e,t,n,i,r){this.octree=e,this.origin=n,this.changed=r,this.pick=i;const a=e.facts,o=a.last_time_s-a.first_time_s,l={size:{value:2},range:{value:new Ye(-1,o+1)},object:{value:i}};this.look=Ii(t,l,Kp,Zp),this.paint={mode:"height",map:"viridis",heights:[0,1],intensities:[...a.intensity],span:o,rings:a.most_ring,file:e.file,hidden:new Set};const[c,h,u]=a.origin_m;this.group.position.set(c-n.x,h-n.y,u-n.z)}octree;origin;changed;group=new Ot;pick;core=new vt;drawnPoints=0;loading=!1;loaded=new Map;waiting=new Set;wanted=[];look;frame=0;failed="";marks=null;other=null;paint;way=0;get error(){return this.failed}get painted(){return this.paint}setPaint(e,t,n){const{paint:i}=this;i.mode===e&&i.map===t&&i.heights.every((r,a)=>r===n[a])||(Object.assign(i,{mode:e,map:t,heights:[...n]}),++this.way)}get size(){return this.look.uniforms.size.value}setSize(e){this.look.uniforms.size.value=e}setTimes(e,t){this.look.uniforms.range.value.set(e,t)}get times(){const{x:e,y:t}=this.look.uniforms.range.value;return e<=0&&t>=this.paint.span?null:[e,t]}setMarksFrom(e){this.marks=e;for(const t of this.loaded.values())t.marks=e?new Uint8Array(4*t.points.count):null;++this.way,e?.need([...this.loaded.keys()])}get marked(){return this.marks?.classes()??null}nodesInMemory(e){return[...this.loaded.keys()].filter(t=>!e||e.has(t.index))}setMarks(e,t){const n=this.loaded.get(e);n?.marks&&(n.marks.set(t),n.painted=-1,this.changed())}async compareWith(e){this.other=e,await this.loadErrors([...this.loaded.keys()])}async loadErrors(e){for(const t of e){const n=await bn(`errors?file=${this.octree.file}&other=${this.other}&nodes=${t.index}`),i=this.loaded.get(t);i&&Object.assign(i,{errors:new Float32Array(n),painted:-1})}this.changed()}setHidden(e){this.paint.hidden=new Set(e),++this.way,this.changed()}async start(){await this.load(this.octree.root);const e=this.loaded.get(this.octree.root)?.points;!e||e.count===0||(this.paint.intensities=ol(e.intensity),this.core.copy(Gi(e.position)).translate(this.octree.root.box.min).translate(this.group.position))}update(e,t,n,i=n){++this.frame;const r=new Kn().setFromProjectionMatrix(new Qe().multiplyMatrices(e.projectionMatrix,e.matrixWorldInverse)),a=t/(2*Math.tan(e.fov*Math.PI/360)),o=e.position.clone().sub(this.group.position),l=[],c=d=>{const f=d.box.clone().translate(this.group.position);if(!r.intersectsBox(f))return;const g=d.box.max.x-d.box.min.x,S=Math.max(d.box.distanceToPoint(o),.1*g);l.push({node:d,size:g/Yp/S*a})};c(this.octree.root);const h=new Set;let u=0;for(this.wanted=[];l.length>0;){let d=0;for(let m=1;m<l.length;++m)l[m].size>l[d].size&&(d=m);const{node:f,size:g}=l.splice(d,1)[0];if(u+f.points>n&&u>0)break;u+=f.points;const S=this.loaded.get(f);S?(h.add(f),S.used=this.frame):this.wanted.push(f),g>1.5&&f.children.forEach(c)}this.loading=this.wanted.length>0,this.loadNext(),this.drawnPoints=0;for(const[d,f]of this.loaded)f.drawn.visible=h.has(d),f.drawn.visible&&(this.drawnPoints+=d.points,f.painted!==this.way&&this.colour(f));this.forget(2*i)}colour(e){const t=e.drawn.position.z+this.group.position.z,[n,i]=this.paint.heights;Wp(e.points,e,{...this.paint,heights:[n-t,i-t]},e.colours),e.painted=this.way,e.drawn.geometry.getAttribute("colour").needsUpdate=!0}*batches(){for(const{points:e,drawn:t,colours:n}of this.loaded.values()){if(!t.visible)continue;const{count:i,position:r,time:a}=e;yield{count:i,position:r,time:a,colours:n,offset:t.position.clone().add(this.group.position)}}}cull(e){const t=new vt;for(const[n,{drawn:i}]of this.loaded)i.visible&&(i.visible=e.intersectsBox(t.copy(n.box).translate(this.group.position)))}forget(e){let t=0;for(const i of this.loaded.keys())t+=i.points;if(t<=e)return;const n=[...this.loaded].sort((i,r)=>i[1].used-r[1].used);for(const[i,{drawn:r,used:a}]of n){if(t<=e||a===this.frame)break;this.group.remove(r),r.geometry.dispose(),this.loaded.delete(i),t-=i.points}}loadNext(){for(;this.waiting.size<qp&&this.wanted.length>0;)this.load(this.wanted.shift())}async load(e){if(!(this.waiting.has(e)||this.loaded.has(e))){this.waiting.add(e);try{const t=await ll(this.octree.file,e);this.show(e,t),this.failed=""}catch(t){this.failed=String(t),await new Promise(n=>setTimeout(n,2e3))}this.waiting.delete(e),this.changed(),this.failed||this.loadNext()}}show(e,t){const n=new ht,i=(l,c,h=1,u=!1)=>n.setAttribute(l,new ct(c,h,u));i("position",t.position,3),i("time",t.time),i("rowBytes",t.rowBytes,4,!0);const r=new Uint32Array(t.count);i("colour",new Uint8Array(r.buffer),4,!0);const a=new Hi(n,this.look);a.position.copy(e.box.min),a.frustumCulled=!1,a.userData.pick=this.pick,this.group.add(a),a.layers.set(Yr);const o=this.marks?new Uint8Array(4*t.count):null;this.loaded.set(e,{points:t,drawn:a,used:this.frame,colours:r,painted:-1,marks:o,errors:null}),this.marks?.need([e]),this.other!==null&&this.loadErrors([e])}placeOf(e){for(const{points:t,drawn:n}of this.loaded.values()){if(!n.visible)continue;const i=t.row.indexOf(e);if(i>=0)return new D().fromArray(t.position,3*i).add(n.position).add(this.group.position)}return null}dispose(){for(const{drawn:e}of this.loaded.values())e.geometry.dispose();this.loaded.clear(),this.look.dispose()}}const Oi=52,Or=2048,Jp=[0,3,5],Qp=3,jp=`
  attribute vec3 mean;
  attribute vec3 diagonal;
  attribute vec3 below;
  attribute vec3 facts;
  uniform float radius;
  uniform vec3 eye;
  varying vec3 from;
  varying vec3 to;
  varying vec3 shownFacts;
  varying mat4 clip;
  varying mat3 factor;
  varying vec3 centre;
  vec3 solved(vec3 v) {
    float x = v.x / diagonal.x;
    float y = (v.y - below.x * x) / diagonal.y;
    return vec3(x, y, (v.z - below.y * x - below.z * y) / diagonal.z);
  }
  void main() {
    factor = mat3(diagonal.x, below.x, below.y, 0.0, diagonal.y, below.z, 0.0, 0.0, diagonal.z) * radius;
    vec3 extent = radius * vec3(diagonal.x, length(vec2(below.x, diagonal.y)), length(vec3(below.y, below.z, diagonal.z)));
    vec3 corner = mean + position * 2.0 * extent;
    from = solved(eye - mean) / radius;
    to = solved(corner - mean) / radius;
    centre = mean;
    shownFacts = facts;
    clip = projectionMatrix * modelViewMatrix;
    gl_Position = clip * vec4(corner, 1.0);
  }
`,ul=`
  // A hash of pixel and element: the share p of the pixels is drawn, whatever lies before or behind.
  float draw(vec2 pixel, float element) {
    vec3 v = fract(vec3(pixel, element) * vec3(0.1031, 0.1030, 0.0973));
    v += dot(v, v.yxz + 33.33);
    return fract((v.x + v.y) * v.z);
  }
  vec3 elementColour(vec3 facts, vec3 shown) {
    return worldMode == 0 ? mapped(facts.x) : worldMode == 1 ? classColour(facts.y)
      : worldMode == 2 ? heightColour(shown) : vec3(0.45, 0.6, 0.4);
  }
`,em=`
  uniform int worldMode;
  uniform mat4 place;
  uniform float opaque;
  varying vec3 from;
  varying vec3 to;
  varying vec3 shownFacts;
  varying mat4 clip;
  varying mat3 factor;
  varying vec3 centre;
  ${ul}
  void main() {
    vec3 d = to - from;
    float a = dot(d, d), b = dot(from, d), c = dot(from, from) - 1.0;
    float root = b * b - a * c;
    if (root < 0.0) discard;
    float t = (-b - sqrt(root)) / a;
    if (t < 0.0) t = (-b + sqrt(root)) / a;
    if (t < 0.0) discard;
    vec3 u = from + t * d;
    vec3 at = centre + factor * u;
    vec4 shown = place * vec4(at, 1.0);
    if (sliced(shown.xyz)) discard;
    if (opaque < 0.5 && draw(floor(gl_FragCoord.xy), shownFacts.z) >= shownFacts.x) discard;
    vec4 screen = clip * vec4(at, 1.0);
    gl_FragDepth = 0.5 + 0.5 * screen.z / screen.w;
    float light = 0.55 + 0.45 * abs(dot(normalize(u), normalize(d)));
    gl_FragColor = pass == 0 ? vec4(elementColour(shownFacts, shown.xyz) * light, 1.0)
      : pass == 1 ? bytesOf(object) : bytesOf(int(shownFacts.z));
  }
`,tm=`
  attribute vec3 facts;
  attribute float width;
  uniform float radius;
  uniform float pixels;
  varying vec3 shownFacts;
  varying vec3 shown;
  varying float cover;
  void main() {
    vec4 world = modelMatrix * vec4(position, 1.0);
    shown = world.xyz;
    shownFacts = facts;
    gl_Position = projectionMatrix * viewMatrix * world;
    float size = radius * width * length(modelMatrix[0].xyz) * pixels / max(gl_Position.w, 1e-3);
    cover = min(1.0, size * size);
    gl_PointSize = clamp(size, 1.0, 64.0);
  }
`,nm=`
  uniform int worldMode;
  uniform float opaque;
  varying vec3 shownFacts;
  varying vec3 shown;
  varying float cover;
  ${ul}
  void main() {
    if (sliced(shown)) discard;
    float share = opaque < 0.5 ? shownFacts.x * cover : cover;
    if (share < 1.0 && draw(floor(gl_FragCoord.xy), shownFacts.z) >= share) discard;
    gl_FragColor = pass == 0 ? vec4(elementColour(shownFacts, shown) * 0.85, 1.0)
      : pass == 1 ? bytesOf(object) : bytesOf(int(shownFacts.z));
  }
`;function im(s,e,t){let n=0;for(let i=0;i<10;++i)n+=((s>>i&1)+2*(e>>i&1)+4*(t>>i&1))*8**i;return n}function sm(s,e){const t=s.length/3,n=Uint32Array.from({length:t},(h,u)=>u);if(t<=Or)return n;const i=e.getSize(new D),r=1023/Math.max(i.x,i.y,i.z,1e-6),{x:a,y:o,z:l}=e.min,c=new Float64Array(t);for(let h=0;h<t;++h)c[h]=im((s[3*h]-a)*r,(s[3*h+1]-o)*r,(s[3*h+2]-l)*r);return n.sort((h,u)=>c[h]-c[u])}function rm(s){const e=s.byteLength/Oi;if(e===0)return null;const t={start:0,bytes:Oi,count:e},n=Ps(s,t,0,3),i=Ps(s,t,12,6),r=Ps(s,t,36,1),a=Ur(s,t,48),o=new vt().setFromArray(n),l=sm(n,o),c=[];for(let d=0;d<e;d+=Or)c.push(am(l.subarray(d,Math.min(e,d+Or)),{mean:n,covariance:i,p:r,label:a}));const h=[-1,1].map(d=>n.map((f,g)=>f+d*Math.sqrt(i[6*Math.floor(g/3)+Jp[g%3]]))),u=new vt(Gi(h[0]).min,Gi(h[1]).max);return{blocks:c,bounds:o,core:u,labels:new Set(a)}}function am(s,e){const t=s.length,n=new Float32Array(3*t),i=new Float32Array(3*t),r=new Float32Array(3*t),a=new Float32Array(3*t),o=new Float32Array(t);s.forEach((d,f)=>{const g=b=>e.covariance[6*d+b],S=Math.sqrt(Math.max(g(0),1e-12)),m=g(1)/S,p=g(2)/S,M=Math.sqrt(Math.max(g(3)-m*m,1e-12)),A=(g(4)-m*p)/M;n.set(e.mean.subarray(3*d,3*d+3),3*f),i.set([S,M,Math.sqrt(Math.max(g(5)-p*p-A*A,1e-12))],3*f),r.set([m,p,A],3*f),a.set([e.p[d],e.label[d],d],3*f),o[f]=Math.sqrt(Math.PI*(g(0)+g(3)+g(5))/3)});const l=new Mi(1,1,1),c=new lc;c.index=l.index,c.setAttribute("position",l.getAttribute("position")),c.setAttribute("mean",new ls(n,3)),c.setAttribute("diagonal",new ls(i,3)),c.setAttribute("below",new ls(r,3)),c.setAttribute("facts",new ls(a,3)),c.instanceCount=t;const h=new ht;h.setAttribute("position",new ct(n,3)),h.setAttribute("facts",new ct(a,3)),h.setAttribute("width",new ct(o,1));const u=new vt().setFromArray(n).getBoundingSphere(new Qn);return{count:t,sphere:u,width:o.reduce((d,f)=>d+f,0)/t,cast:c,splats:h}}function mo(s,e,{frame:t,pick:n}){t.add(s),s.updateMatrixWorld(!0),s.frustumCulled=!1,s.raycast=()=>{},s.userData.pick=n;const i=new Qe;s.onBeforeRender=(r,a,o)=>{e.uniforms.object.value=n,e.uniforms.eye&&(i.copy(s.matrixWorld).invert(),e.uniforms.eye.value.setFromMatrixPosition(o.matrixWorld).applyMatrix4(i),e.uniforms.place.value=s.matrixWorld),e.uniformsNeedUpdate=!0}}function go(s,e,t){e==="cast"&&!s.cast?(s.cast=new fn(s.block.cast,t.cast),mo(s.cast,t.cast,s)):e==="splats"&&!s.splats&&(s.splats=new Hi(s.block.splats,t.splats),mo(s.splats,t.splats,s)),s.cast&&(s.cast.visible=e==="cast"),s.splats&&(s.splats.visible=e==="splats")}function om(s,e,t,n,i,r){const a=new Kn().setFromProjectionMatrix(new Qe().multiplyMatrices(e.projectionMatrix,e.matrixWorldInverse)),o=t/(2*Math.tan(e.fov*Math.PI/360));r.splats.uniforms.pixels.value=o;const l=new Qn,c=[];for(const u of s){const{block:d,frame:f}=u,g=f.scale.x;if(l.copy(d.sphere).applyMatrix4(f.matrixWorld),l.radius+=3*n*d.width*g,!f.visible||!a.intersectsSphere(l)){go(u,null,r);continue}const S=Math.max(l.center.distanceTo(e.position)-l.radius,e.near);c.push({placed:u,size:n*d.width*g*o/S})}c.sort((u,d)=>d.size-u.size);const h={inView:0,cast:0};for(const{placed:u,size:d}of c){const{count:f}=u.block,g=d>=Qp&&h.cast+f<=Math.max(i,f);go(u,g?"cast":"splats",r),h.inView+=f,g&&(h.cast+=f)}return h}const lm=.3,cm=`
  attribute float p;
  varying vec3 shown;
  varying vec3 seen;
  varying float share;
  void main() {
    vec4 world = modelMatrix * vec4(position, 1.0);
    shown = world.xyz;
    share = p;
    vec4 view = viewMatrix * world;
    seen = view.xyz;
    gl_Position = projectionMatrix * view;
    // Points on a mesh, half of which lie a little below it, are drawn before it.
    vec4 behind = projectionMatrix * vec4(seen + normalize(seen) * float(${lm}), 1.0);
    gl_Position.z = behind.z / behind.w * gl_Position.w;
  }
`,hm=`
  uniform int worldMode;
  varying vec3 shown;
  varying vec3 seen;
  varying float share;
  void main() {
    if (sliced(shown)) discard;
    vec3 normal = normalize(cross(dFdx(seen), dFdy(seen)));
    vec3 colour = worldMode == 0 ? mapped(share) : worldMode == 2 ? heightColour(shown) : vec3(0.62, 0.55, 0.45);
    float light = 0.5 + 0.5 * abs(dot(normal, normalize(seen)));
    gl_FragColor = pass == 0 ? vec4(colour * light, 1.0) : pass == 1 ? bytesOf(object) : bytesOf(0);
  }
`;function _o(s){const[e=0,t=0]=new Uint32Array(s,0,2),n=new Float32Array(s,8,3*e),i=new Uint32Array(s,8+12*e,3*t),r=new Float32Array(s,8+12*e+12*t,t),a=new Float32Array(e),o=new Uint16Array(e);i.forEach((c,h)=>{a[c]=a[c]+r[Math.floor(h/3)],o[c]=o[c]+1}),a.forEach((c,h)=>a[h]=c/Math.max(1,o[h]));const l=new ht;return l.setAttribute("position",new ct(n,3)),l.setAttribute("p",new ct(a,1)),l.setIndex(new ct(i,1)),l.computeBoundingBox(),l.userData.core=Gi(n),l}class Zr{constructor(e,t,n,i){this.file=e,this.facts=t,this.display=n,this.group.position.set(...t.origin_m).sub(i),this.home=this.group.position.clone();const r={radius:{value:1},opaque:{value:0},object:{value:0}},a={eye:{value:new D},place:{value:this.group.matrixWorld}};this.ellipsoidLooks={cast:Ii(n,{...r,...a},jp,em),splats:Ii(n,{...r,pixels:{value:1}},tm,nm)},this.ellipsoidLooks.cast.side=1}file;facts;display;group=new Ot;bounds=new vt;labels=new Set;drawnEllipsoids=0;castEllipsoids=0;home;meshMaterial=null;ellipsoidLooks;placed=[];models=new Map;frames=[];pick=()=>0;radius=1;static async open(e,t,n,i,r){const a=await ut(`world?file=${e.id}`),o=new Zr(e,a,t,n),l=[...new Set(a.instances.map(c=>c.model))];for(const[c,h]of l.entries())o.models.set(h,await o.load(h)),r((c+1)/l.length);return o.pick=i,a.instances.forEach((c,h)=>o.place(h)),o}async load(e){const t=`file=${this.file.id}&model=${e}`,n=this.facts.models[e],i=new DataView(await bn(`ellipsoids?${t}`)),r=[];if(n.ground_triangles>0){const a=await bn(`ground?${t}`);r.push({kind:"ground",geometry:_o(a),data:a})}if(n.surface_triangles>0){const a=await bn(`surface?${t}`);r.push({kind:"surface",geometry:_o(a),data:a})}return{ellipsoids:i,blocks:rm(i),meshes:r}}place(e){const{pick:t}=this,n=this.facts.instances[e],i=this.models.get(n.model),r=new Ot;r.position.set(...n.at_m);const[a,o,l,c]=n.rotation_wxyz;if(r.quaternion.copy(new Un(o,l,c,a)),r.scale.setScalar(n.scale),this.group.add(r),(this.frames[e]??=[]).push(r),i.blocks){const h=t({world:this,instance:e,part:"ellipsoid"});for(const u of i.blocks.blocks)this.placed.push({block:u,frame:r,pick:h,cast:null,splats:null})}for(const{kind:h,geometry:u}of i.meshes){const d=new fn(u,this.meshLook());d.userData.pick=t({world:this,instance:e,part:h}),d.onBeforeRender=()=>{const f=d.material;f.uniforms.object.value=d.userData.pick,f.uniformsNeedUpdate=!0},r.add(d)}this.group.updateMatrixWorld(!0),i.blocks?.labels.forEach(h=>this.labels.add(h));for(const h of[i.blocks?.core,...i.meshes.map(u=>u.geometry.userData.core)])h&&this.bounds.union(h.clone().applyMatrix4(r.matrixWorld));return r}boxOf(e){const{min:t,max:n}=this.facts.models[this.facts.instances[e].model].box_m;return new vt(new D(...t),new D(...n)).applyMatrix4(this.frames[e][0].matrixWorld)}showAlone(e){this.frames.forEach((t,n)=>t.forEach(i=>i.visible=e===null||n===e))}get moves(){return this.facts.instances.some(e=>e.moves)}moveTo(e){const t=new Map;for(const{instance:n,at:i,turn:r}of e){const a=t.get(n)??0;t.set(n,a+1);const o=this.frames[n][a]??this.place(n);o.position.copy(i),o.quaternion.copy(r)}this.facts.instances.forEach(({moves:n},i)=>{n&&this.frames[i].forEach((r,a)=>r.visible=a<(t.get(i)??0))}),this.group.updateMatrixWorld(!0)}update(e,t,n){const{inView:i,cast:r}=om(this.placed,e,t,this.radius,n,this.ellipsoidLooks);this.drawnEllipsoids=i,this.castEllipsoids=r}standBeside(e){const t=this.home.clone();if(this.bounds.translate(this.home.clone().sub(this.group.position)),e&&!e.isEmpty()){const n=2+.05*(e.max.y-e.min.y),i=r=>(r.min.x+r.max.x)/2;t.add(new D(i(e)-i(this.bounds),e.min.y-n-this.bounds.max.y,e.min.z-this.bounds.min.z))}this.bounds.translate(t.clone().sub(this.home)),this.group.position.copy(t),this.group.updateMatrixWorld(!0)}meshLook(){return this.meshMaterial??=Ii(this.display,{object:{value:0}},cm,hm),this.meshMaterial.side=2,this.meshMaterial}setMode(e){this.display.uniforms.worldMode.value=qs.indexOf(e)}setRadius(e){this.radius=e,this.ellipsoidLooks.cast.uniforms.radius.value=e}setOpaque(e){this.ellipsoidLooks.cast.uniforms.opaque.value=Number(e)}ellipsoid(e,t){const n=this.models.get(this.facts.instances[e].model).ellipsoids,i=o=>n.getFloat32(t*Oi+4*o,!0),r=o=>n.getUint32(t*Oi+4*o,!0),a=[i(3),i(6),i(8)].map(Math.sqrt);return{p:i(9),hits:r(10),misses:r(11),label:r(12),semiAxes:a}}triangle(e,t,n){const i=this.models.get(this.facts.instances[e].model),r=new DataView(i.meshes.find(c=>c.kind===t).data),[a,o]=[r.getUint32(0,!0),r.getUint32(4,!0)],l=8+12*a+12*o+4*n;return{p:r.getFloat32(l,!0),hits:r.getUint32(l+4*o,!0),misses:r.getUint32(l+8*o,!0)}}centreOf(e,t){const n=this.models.get(this.facts.instances[e].model).ellipsoids,i=r=>n.getFloat32(t*Oi+4*r,!0);return new D(i(0),i(1),i(2)).applyMatrix4(this.frames[e][0].matrixWorld)}dispose(){for(const{blocks:e,meshes:t}of this.models.values())e?.blocks.forEach(n=>[n.cast,n.splats].forEach(i=>i.dispose())),t.forEach(n=>n.geometry.dispose());[this.meshMaterial,this.ellipsoidLooks.cast,this.ellipsoidLooks.splats].forEach(e=>e?.dispose())}}const dm=4294967294,um=1e3;function fm(){return new Promise(s=>{requestAnimationFrame(()=>requestAnimationFrame(()=>s())),setTimeout(s,um)})}class pm{constructor(e,t,n){this.list=e,this.viewer=t,this.tell=n}list;viewer;tell;clouds=new Map;worlds=new Map;origin=null;opening=new Map;beams=null;previews=new Map;onPreview=()=>{};file(e){return this.list[e]}async show(e,t){t&&!this.opening.has(e)&&(this.opening.set(e,this.open(this.file(e))),this.opening.get(e).catch(()=>this.opening.delete(e)),this.viewer.draw()),t&&await this.opening.get(e);const n=this.clouds.get(e)?.group??this.worlds.get(e)?.group;n&&(n.visible=t),this.arrange(),this.viewer.draw()}arrange(){const e=[...this.worlds.values()].filter(i=>i.file.kind==="primitives"),t=e.filter(i=>i.group.visible);t.forEach(i=>i.group.visible=!1);const n=this.viewer.isEmpty?null:this.viewer.bounds();t.forEach(i=>i.group.visible=!0),e.forEach(i=>i.standBeside(n))}get loading(){return this.previews.size>0?!0:[...this.opening.keys()].some(e=>!this.clouds.has(e)&&!this.worlds.has(e))}async open(e){const t=`${e.name}: `,n=i=>this.tell(`${t}${Math.round(100*i)} %`,t);if(this.tell(t,""),e.kind==="log"){const i=await Op(e.id,n,()=>this.preview(e));this.origin??=new D(...i.facts.origin_m);const r=this.viewer.target({kind:"beam",file:e.id}),a=new po(i,this.viewer.display,this.origin,r,()=>this.viewer.drawSoon());await a.start(),this.viewer.replaceTarget(r,{kind:"point",cloud:a}),this.clouds.set(e.id,a),this.viewer.addCloud(a),this.endPreview(e.id,a)}else{const i=await ut(`world?file=${e.id}`);this.origin??=new D(...i.origin_m);const r=await Zr.open(e,this.viewer.display,this.origin,a=>this.viewer.target({kind:"world",...a}),n);this.worlds.set(e.id,r),this.viewer.addWorld(r)}this.tell("",t)}async preview(e){const t=await Bp(e.id);if(!t||this.clouds.has(e.id))return;this.origin??=new D(...t.facts.origin_m);const n=new po(t,this.viewer.display,this.origin,dm,()=>this.viewer.drawSoon());await n.start(),!this.clouds.has(e.id)&&(this.previews.set(e.id,n),this.viewer.addCloud(n),this.onPreview(),await fm())}endPreview(e,t){const n=this.previews.get(e);if(n){if(t.group.visible&&t.loading&&t.drawnPoints<n.drawnPoints){setTimeout(()=>this.endPreview(e,t),50);return}this.previews.delete(e),this.viewer.removeCloud(n)}}async showBeams(e,t){this.beams&&(this.viewer.remove(this.beams),Lp(this.beams),this.beams=null);const n=this.clouds.get(e);if(t===null||!n)return"";const i=this.viewer.target({kind:"beam",file:e}),{lines:r,beams:a,step:o}=await Pp(e,t,this.viewer.display,n.group.position,i);return this.beams=r,this.viewer.add(r),o>1?`${a} beams, each ${o}th`:`${a} beams`}}const mm=300;class gm{constructor(e,t){this.app=e,this.menu=t,e.section("Commands",this.list),e.run(this.refresh())}app;menu;onFiles=[];list=L("ul",{class:"jobs","aria-label":"Commands"});watched=new Map;timer=0;named=new Set;freshName(e,t=""){const n=new Set(this.app.files.list.map(r=>r.name)),i=Math.floor(Date.now()/1e3).toString(36);for(let r=1;;++r){const a=`${e.replace(/[^A-Za-z0-9_-]/g,"_").slice(0,40)}-${i}${r>1?`-${r}`:""}${t}`;if(!(n.has(a)||this.named.has(a)))return this.named.add(a),a}}async run(e,t){const n=await En("jobs/start",{verb:e,...t});this.app.tell(n.command);const i=new Promise(a=>this.watched.set(n.number,a));await this.refresh();const r=await i;if(await this.newFiles(),r.state!=="done")throw new Error(`${e}: ${r.state}${r.progress?`: ${r.progress}`:""}`)}async runAndShow(e,t){await this.run(e,t);const n=this.app.files.list.find(i=>i.name===t.name);if(!n)throw new Error(`${e}: its result is not there`);return await this.menu.toggle(n,!0),n.id}async newFiles(){const{files:e}=await ut("files");for(const t of e.slice(this.app.files.list.length))this.app.files.list.push(t),this.menu.addFile(t);this.onFiles.forEach(t=>t())}async refresh(){clearTimeout(this.timer);const{jobs:e}=await ut("jobs");this.list.replaceChildren(...e.slice(-20).reverse().map(t=>this.row(t))),$e.dataset.jobs=e.map(t=>`${t.verb} ${t.state}`).join(", ");for(const t of e)t.state!=="running"&&(this.watched.get(t.number)?.(t),this.watched.delete(t.number));e.some(t=>t.state==="running")&&(this.timer=window.setTimeout(()=>this.app.run(this.refresh()),mm))}row(e){const t=e.state==="running"?e.progress||"running":`${e.state}, ${e.seconds.toFixed(1)} s`,n=Ae("Output",`Output of ${e.verb}`,()=>this.app.run(this.showLog(e)));n.setAttribute("aria-label",`Output of ${e.verb}`);const i=Ae("Cancel",`Cancel ${e.verb}`,()=>this.app.run(En("jobs/cancel",{number:e.number}).then(()=>this.refresh())));return L("li",{},L("code",{},e.command),L("div",{},t),n,...e.state==="running"?[i]:[])}async showLog(e){const{log:t,progress:n}=await ut(`jobs/log?${un({number:e.number})}`),i=Ae("×","Close (Escape)",()=>this.app.closeDetails());this.app.showDetails([L("div",{class:"head"},L("h2",{},`Output of ${e.verb}`),i),L("pre",{class:"log",tabindex:"0"},`${t}${n}`)])}}class _m{constructor(e){this.actions=e}actions;element=L("div",{class:"classes",role:"group","aria-label":"Classes to label"});rows=[];show(e,t,n,i){this.rows.length!==e.classes.length&&this.build(e),e.classes.forEach((r,a)=>{const o=this.rows[a];o.points.textContent=`${r.points}`,o.radio.checked=a===t,o.hide.setAttribute("aria-pressed",`${n.has(a)}`),o.lock.setAttribute("aria-pressed",`${i.has(a)}`)})}build(e){this.rows.length=0,this.element.replaceChildren(),e.classes.forEach((t,n)=>{const i=L("input",{type:"radio",name:"label-class",value:`${n}`});i.addEventListener("change",()=>this.actions.choose(n));const r=L("span",{class:"swatch"});r.style.background=cn.css(n);const a=L("span",{class:"count"}),o=(u,d,f)=>{const g=Ae(u,`${d} ${t.name}`,f);return g.setAttribute("aria-label",`${d} ${t.name}`),g},l=o("◌","Hide",()=>this.actions.hide(n)),c=o("⚿","Lock",()=>this.actions.lock(n)),h=o("◉","Show only",()=>this.actions.isolate(n));this.rows.push({points:a,radio:i,hide:l,lock:c}),this.element.append(L("div",{class:"class"},L("label",{},i,r,t.name),a,l,c,h))})}}function vm(s,e){const t=Math.max(1,...e.counts),n=document.createElementNS("http://www.w3.org/2000/svg","svg");n.setAttribute("viewBox",`0 0 ${e.counts.length} 20`),n.setAttribute("preserveAspectRatio","none"),n.setAttribute("class","histogram"),n.setAttribute("role","img");const i=`${e.low.toFixed(2)} to ${e.high.toFixed(2)}`;return n.setAttribute("aria-label",`${s} of the selection, ${i}`),e.counts.forEach((r,a)=>{const o=document.createElementNS("http://www.w3.org/2000/svg","rect"),l=20*r/t;for(const[c,h]of Object.entries({x:a,y:20-l,width:.9,height:l}))o.setAttribute(c,`${h}`);n.append(o)}),L("figure",{},n,L("figcaption",{},`${s}: ${i}`))}const xm=2e6,Sm=500;class pi{constructor(e,t,n){this.file=e,this.cloud=t,this.tell=n,pi.all.add(this)}file;cloud;tell;state=null;pending=0;trouble="";queue=Promise.resolve();wanted=new Set;fetching=!1;static all=new Set;changed(){const e=[...pi.all];$e.dataset.saved=e.some(t=>t.trouble)?"no":e.some(t=>t.loading)?"soon":"yes",this.tell()}close(){this.cloud?.setMarksFrom(null),pi.all.delete(this)}async open(){this.state=await ut(`labels?file=${this.file}`),this.cloud?.setMarksFrom(this),this.changed()}classes(){return(this.state?.classes??[]).map(({name:e,points:t},n)=>({number:n,name:e,points:t})).filter(e=>e.points>0)}get loading(){return this.fetching||this.wanted.size>0||this.pending>0}async sync(){const e=this.state?.revision??0,t=await ut(`labels?file=${this.file}&since=${e}`);this.state=t,this.cloud&&this.need(this.cloud.nodesInMemory(new Set(t.nodes))),this.changed()}send(e,t,n){++this.pending,this.changed();const i=this.queue.then(()=>this.sent(e,t,n));return this.queue=i.catch(()=>{}),i.finally(()=>{--this.pending,this.changed()})}async sent(e,t,n){try{const i=()=>En(`labels/${e}`,{file:this.file,revision:this.state.revision,...t}),r=await i().catch(async a=>{if(!(a instanceof il))throw a;if(await this.sync(),!n)throw new Error("Another window changed the labels: look at what it did, then try again");return i()});return await this.sync(),this.trouble="",r}catch(i){throw this.trouble=i instanceof TypeError?"the program does not answer":String(i.message),i}}edit(e){return this.send("edit",e,!0)}need(e){e.forEach(t=>this.wanted.add(t)),!this.fetching&&this.wanted.size>0&&this.fetchMarks()}async fetchMarks(){this.fetching=!0;try{for(;this.wanted.size>0;){await Promise.resolve();const e=[];let t=0;for(const r of this.wanted){if(e.length>=Sm||t>0&&t+r.points>xm)break;e.push(r),t+=r.points,this.wanted.delete(r)}const n=await bn(`labels/data?${un({file:this.file,nodes:e.map(r=>r.index)})}`);let i=0;for(const r of e)this.cloud.setMarks(r,new Uint8Array(n,i,4*r.points)),i+=4*r.points}}catch(e){this.trouble=String(e)}this.fetching=!1,this.changed()}}const Ar="http://www.w3.org/2000/svg",Mm=150,wm=200;function ym(){return(crypto.getRandomValues(new Uint32Array(1))[0]|1)>>>0}function bm(s,e){let t=s;for(let n=1;t.length/2>e;n*=1.5){const i=[];for(let r=0;r<s.length;r+=2){const[a,o]=[s[r],s[r+1]],l=i.length;(l===0||Math.hypot(a-i[l-2],o-i[l-1])>=n)&&i.push(a,o)}t=i}return t.map(n=>Math.round(n*10)/10)}class Em{constructor(e,t,n){this.canvas=e,this.navigation=t,this.done=n,this.layer=document.createElementNS(Ar,"svg"),this.layer.id="draw",this.layer.setAttribute("aria-hidden","true"),this.shape=document.createElementNS(Ar,"path"),this.ring=document.createElementNS(Ar,"circle"),this.layer.append(this.shape,this.ring),e.after(this.layer),this.layer.addEventListener("pointerdown",i=>this.down(i)),this.layer.addEventListener("pointermove",i=>this.move(i)),this.layer.addEventListener("pointerup",i=>this.up(i)),this.layer.addEventListener("pointercancel",i=>this.up(i)),this.layer.addEventListener("contextmenu",i=>i.preventDefault()),this.layer.addEventListener("wheel",i=>{i.preventDefault(),i.shiftKey&&this.tool==="brush"?this.setRadius(this.radius*Math.exp(-i.deltaY*.001)):t.zoom(Math.exp(i.deltaY*.001))},{passive:!1}),window.addEventListener("keydown",i=>this.hold(i,!0)),window.addEventListener("keyup",i=>this.hold(i,!1)),this.take(null)}canvas;navigation;done;tool=null;radius=20;layer;shape;ring;path=[];drawing=!1;steering=!1;stroke=0;part=0;space=!1;take(e){this.tool=e,this.drawing=!1,this.path=[],this.layer.toggleAttribute("hidden",e===null),this.layer.dataset.tool=e??"",this.show()}setRadius(e){this.radius=Math.min(200,Math.max(2,e)),this.show()}hold(e,t){e.key===" "&&this.tool&&!(e.target instanceof HTMLButtonElement)&&(this.space=t,e.preventDefault())}at(e){const t=this.canvas.getBoundingClientRect();return[e.clientX-t.left,e.clientY-t.top]}down(e){if(this.layer.setPointerCapture(e.pointerId),this.canvas.focus(),e.button!==0||this.space){this.steering=!0;return}this.drawing=!0,this.stroke=ym(),this.part=performance.now(),this.path=this.at(e),this.show()}move(e){const[t,n]=this.at(e);if(this.ring.setAttribute("cx",`${t}`),this.ring.setAttribute("cy",`${n}`),this.steering){const i=4/Math.max(1,this.canvas.clientHeight);e.shiftKey?this.navigation.shift(-e.movementX*i*.25,e.movementY*i*.25,0):this.navigation.orbit(e.movementX*i,e.movementY*i);return}if(this.drawing){if(this.tool==="rectangle"){const[i,r]=[this.path[0],this.path[1]];this.path=[i,r,t,r,t,n,i,n]}else this.path.push(t,n);this.show(),this.tool==="brush"&&performance.now()-this.part>wm&&(this.send(e),this.path=[t,n],this.part=performance.now())}}up(e){if(this.steering){this.steering=!1;return}this.drawing&&(this.drawing=!1,this.send(e),this.path=[],this.show())}send(e){const t=this.tool==="brush",n=bm(this.path,Mm);!t&&n.length<6||this.done({path:n,radius:t?this.radius:0,width:this.canvas.clientWidth,height:this.canvas.clientHeight,stroke:this.stroke,shift:e.shiftKey,alt:e.altKey})}show(){const e=[];for(let n=0;n<this.path.length;n+=2)e.push(`${this.path[n]} ${this.path[n+1]}`);const t=this.tool==="brush";this.shape.setAttribute("d",e.length>0?`M${e.join("L")}${t?"":"Z"}`:""),this.shape.setAttribute("stroke-width",t?`${2*this.radius}`:"1.5"),this.shape.setAttribute("class",t?"brush":"lasso"),this.ring.setAttribute("r",t?`${this.radius}`:"0")}}const Ss=["paint","select","add","take away"];class Tm{constructor(e,t){this.app=e,this.menu=t,this.tools=new Em(e.viewer.canvas,e.viewer.navigation,n=>this.drawn(n)),this.classes=new _m({choose:n=>this.choose(n),hide:n=>this.toggle(this.hidden,n),lock:n=>this.toggle(this.locked,n),isolate:n=>this.isolate(n)}),this.modeBox=dn("Drawing",Ss,this.mode,n=>this.mode=n),this.scan.addEventListener("change",()=>this.showScan()),this.choice.addEventListener("change",()=>e.run(this.open(this.choice.value===""?null:Number(this.choice.value)))),e.onClose.push(()=>this.take(null)),this.build(),this.listLogs()}app;menu;labelled=null;current=1;mode="paint";hidden=new Set;locked=new Set;tools;onChange=[];depth=0;onlyTimes=!1;classes;saved=L("p",{class:"note",role:"status","aria-label":"Saved"});facts=L("div");body=L("div",{hidden:""});choice=L("select",{"aria-label":"Log to label"});modeBox;scan=L("select",{"aria-label":"Scan to label"});toolButtons=new Map;undoButton=Ae("Undo","Undo (Z)",()=>this.step(!0));redoButton=Ae("Redo","Redo (Y)",()=>this.step(!1));listLogs(){const e=this.choice.value;this.choice.replaceChildren(L("option",{value:""},"choose a log to label"),...this.app.of("log").map(t=>L("option",{value:`${t.id}`},t.name))),this.choice.value=e}async open(e){if(this.labelled?.close(),this.labelled=null,this.body.hidden=e===null,this.choice.value=e===null?"":`${e}`,e===null)return this.changed();const t=this.app.files.file(e);await this.menu.toggle(t,!0);const n=new pi(e,this.app.files.clouds.get(e),()=>this.changed());await n.open(),this.labelled=n,n.cloud.setHidden(this.hidden),this.listScans(),this.app.state.points="class",this.menu.pointMode.set("class"),this.app.apply(),this.changed()}listScans(){const e=[...new Set(this.labelled.cloud.octree.runs.map(t=>t.scan))].slice(0,5e3);this.scan.replaceChildren(L("option",{value:""},"all"),...e.map(t=>L("option",{value:`${t}`},`${t}`)))}showScan(){this.menu.time.showScan(this.labelled.cloud.octree,this.scan.value===""?null:Number(this.scan.value))}get file(){return this.labelled?this.app.files.file(this.labelled.file):null}take(e){if(e&&!this.labelled){this.app.tell("Choose a log to label in the menu");return}this.tools.take(this.tools.tool===e?null:e),$e.dataset.tool=this.tools.tool??"",this.toolButtons.forEach((t,n)=>t.setAttribute("aria-pressed",`${n===this.tools.tool}`))}conditions(){const{state:e,files:t}=this.app,n={hidden:[...this.hidden],locked:[...this.locked]};if(e.slice.on){const i=["x","y","z"].indexOf(e.slice.axis),r=e.slice.at+t.origin.getComponent(i),a=e.slice.thickness/2;n.slab=[0,1,2].map(o=>+(o===i)).concat(r-a,r+a)}return this.onlyTimes&&(n.times=this.menu.shownTimes()),this.scan.value!==""&&(n.scan=Number(this.scan.value)),n}deed(e,t){const n=this.labelled.state;if(this.mode==="paint"){const a=t?0:this.current;return{name:n.classes[a].name,change:{class:a,of_class:t?this.current:null}}}const i=e?"add":t?"take away":this.mode;return{name:i,change:{select:i==="add"?"add":i==="take away"?"remove":"only"}}}intercept=null;change(e,t){const{name:n,change:i}=this.deed(!1,!1);this.send({...this.conditions(),...e,...i,name:`${t}: ${n}`})}drawn(e){if(this.intercept?.(e)||!this.labelled)return;if(this.app.viewer.sides?.mode==="split"){this.app.tell("Draw on one picture: leave the split screen first (0)");return}const{camera:t}=this.app.viewer,{cloud:n}=this.labelled;t.updateMatrixWorld();const i=new Qe().multiplyMatrices(t.projectionMatrix,t.matrixWorldInverse).multiply(new Qe().makeTranslation(n.group.position)),{name:r,change:a}=this.deed(e.shift,e.alt);e.radius>0&&a.select==="only"&&(this.lastStroke===e.stroke&&(a.select="add"),this.lastStroke=e.stroke);const o={matrix:i.elements,path:e.path,radius:e.radius,width:e.width,height:e.height,depth:this.depth},l=this.tools.tool??"lasso";this.send({...this.conditions(),...o,...a,stroke:e.stroke,name:`${l}: ${r}`})}lastStroke=0;send(e){this.app.run(this.labelled.edit(e).then(t=>{$e.dataset.edited=`${t.rows}`,this.app.tell(`${t.rows} points changed`)}))}ofSelected(e,t){if(!this.labelled?.state?.selected){this.app.tell("Nothing is selected");return}this.send({...this.conditions(),of_selected:1,...e,name:t})}step(e){this.labelled&&this.app.run(this.labelled.send(e?"undo":"redo",{},!1))}choose(e){const t=this.labelled?.state?.classes.length??1;this.current=(e+t)%t,this.changed()}toggle(e,t){e.delete(t)||e.add(t),this.labelled?.cloud?.setHidden(this.hidden),this.changed()}isolate(e){const t=(this.labelled?.state?.classes??[]).map((i,r)=>r).filter(i=>i!==e),n=t.every(i=>this.hidden.has(i));this.hidden.clear(),n||t.forEach(i=>this.hidden.add(i)),this.labelled?.cloud?.setHidden(this.hidden),this.changed()}build(){const e=(r,a,o)=>{const l=Ae(a,`${a} (${o})`,()=>this.take(r));return this.toolButtons.set(r,l),l},t=Kt("Depth limit, m",[0,5,.05],0,r=>this.depth=r);t.row.title="Only points at most this far behind the nearest; 0 = all that lie behind";const n=Kt("Brush, pixels",[2,100,1],this.tools.radius,r=>this.tools.setRadius(r)),i=In("Only the times shown below",!1,r=>this.onlyTimes=r);this.body.append(L("div",{class:"buttons"},e(null,"Move","Escape"),e("lasso","Lasso","O"),e("brush","Brush","I"),e("rectangle","Rectangle","K")),...[this.modeBox,t,n,i].map(r=>r.row),L("label",{class:"row",title:"Only points of this scan are changed"},"Scan",this.scan),L("div",{class:"buttons"},this.undoButton,this.redoButton),this.saved,this.classes.element,this.facts,L("div",{class:"buttons"},...this.selectionButtons())),this.app.section("Label",this.choice,this.body)}selectionButtons(){return[Ae("Slab","Give the class to all points of the slice, or select them (J)",()=>this.slab()),Ae("Give class","Give the class to what is selected (R)",()=>this.giveClass()),Ae("New instance","Make one instance of what is selected, also to split or to merge (G)",()=>this.newInstance()),Ae("No instance","Take the instance off what is selected",()=>this.ofSelected({instance:0},"no instance")),Ae("Clear","Select nothing (U)",()=>this.ofSelected({select:"remove"},"clear")),Ae("Histogram","Heights and intensities of what is selected",()=>this.app.run(this.showHistogram()))]}giveClass(){this.ofSelected({class:this.current},this.labelled?.state?.classes[this.current]?.name??"")}newInstance(){this.ofSelected({instance:"new"},"new instance")}slab(){if(!this.labelled||!this.app.state.slice.on){this.app.tell("Switch the slice on first (X)");return}this.change({},"slab")}async showHistogram(){if(!this.labelled)return;const e=await ut(`labels/count?${un({file:this.labelled.file,of_selected:1})}`),t=Object.entries(e.histogram).map(([i,r])=>vm(i.replace("_m",", m"),r)),n=Ae("×","Close (Escape)",()=>this.app.closeDetails());this.app.showDetails([L("div",{class:"head"},L("h2",{},`${e.points} selected points`),n),...t])}changed(){const e=this.labelled?.state;if(e){this.classes.show(e,this.current,this.hidden,this.locked),this.undoButton.disabled=e.undos===0,this.redoButton.disabled=e.redos===0,this.undoButton.textContent=e.undos>0?`Undo “${e.last}” (${e.undos})`:"Undo",this.redoButton.textContent=e.redos>0?`Redo “${e.next}” (${e.redos})`:"Redo";const{pending:t,trouble:n}=this.labelled;this.saved.textContent=n?`Not saved: ${n}`:t>0?`Saving ${t}…`:`All is saved (state ${e.revision})${e.lost_bytes?`; ${e.lost_bytes} damaged bytes were set aside`:""}`,this.facts.textContent=`${e.selected} points selected`,$e.dataset.revision=`${e.revision}`,$e.dataset.selected=`${e.selected}`}this.onChange.forEach(t=>t()),this.app.viewer.draw()}actions(){const e=n=>()=>this.tools.setRadius(this.tools.radius*n);return[{key:"o",name:"label: lasso",act:()=>this.take("lasso")},{key:"i",name:"label: brush",act:()=>this.take("brush")},{key:"k",name:"label: rectangle",act:()=>this.take("rectangle")},{key:"j",name:"label: the slice as a slab",act:()=>this.slab()},{key:"h",name:"label: paint, select, add, take away",act:()=>{this.mode=Ss[(Ss.indexOf(this.mode)+1)%Ss.length],this.modeBox.set(this.mode)}},{key:",",name:"label: the class before",act:()=>this.choose(this.current-1)},{key:".",name:"label: the next class",act:()=>this.choose(this.current+1)},{key:"[",name:"label: smaller brush",act:e(.8)},{key:"]",name:"label: larger brush",act:e(1.25)},{key:"r",name:"label: give the class to what is selected",act:()=>this.giveClass()},{key:"g",name:"label: make an instance of what is selected",act:()=>this.newInstance()},{key:"u",name:"label: select nothing",act:()=>this.ofSelected({select:"remove"},"clear")},{key:"4",name:"label: hide the class",act:()=>this.toggle(this.hidden,this.current)},{key:"5",name:"label: lock the class",act:()=>this.toggle(this.locked,this.current)},{key:"6",name:"label: show only the class",act:()=>this.isolate(this.current)},{key:"z",name:"label: undo",act:()=>this.step(!0)},{key:"y",name:"label: redo",act:()=>this.step(!1)}]}}class Am{constructor(e){this.facts=e,e.primitives.forEach(({folder:t},n)=>this.numbers.set(t,n)),this.rows=e.primitives.map((t,n)=>({...t,model:n,out:!1}))}facts;rows;edits=new Map;past=[];undone=[];numbers=new Map;get undos(){return this.past.length}get redos(){return this.undone.length}list(){return[...this.edits.values()].sort((e,t)=>this.numbers.get(e.primitive)-this.numbers.get(t.primitive))}classesOf(e){const t=this.facts.primitives[e].class;return this.facts.classes.find(n=>n.name===t)?.may_become??[t]}change(e,t){const{class:n}=t,i=e.filter(l=>n===void 0||this.classesOf(l).includes(n));if(e.length===0)throw new Error("There is nothing to change");if(i.length===0)throw new Error(`None of these may become ${n}`);if(new TextEncoder().encode(t.name??"").length>this.facts.most_name_bytes)throw new Error(`A name has ${this.facts.most_name_bytes} bytes at most`);const a=new Set(i);if(t.out&&this.rows.every(l=>l.out||a.has(l.model)))throw new Error("One primitive at least must remain");const o=i.map(l=>this.stepOf(l,t));return this.past.push(o),this.undone=[],o.forEach(({primitive:l,after:c})=>this.take(l,c)),i.length}stepOf(e,t){const n=this.facts.primitives[e],{out:i,name:r,class:a}={...this.rows[e],...t},o=n.folder,l=i?{primitive:o,remove:!0}:{primitive:o};return!i&&a!==n.class&&(l.class=a),!i&&r!==n.name&&(l.name=r),{primitive:o,before:this.edits.get(o),after:Object.keys(l).length>1?l:void 0}}undo(){const e=this.past.pop();e&&(this.undone.push(e),e.forEach(t=>this.take(t.primitive,t.before)))}redo(){const e=this.undone.pop();e&&(this.past.push(e),e.forEach(t=>this.take(t.primitive,t.after)))}replace(e){const t=new Map;if(!Array.isArray(e))throw new Error("edits: must be a list");e.forEach((n,i)=>{const r=this.numbers.get(n?.primitive??"");if(!n||r===void 0)throw new Error(`edits[${i}].primitive: there is no such primitive`);if(t.has(n.primitive))throw new Error(`edits[${i}].primitive: an edit before names it, too`);const{primitive:a,remove:o,class:l,name:c}=n;if(l!==void 0&&!this.classesOf(r).includes(l))throw new Error(`edits[${i}].class: not for this primitive`);if(c!==void 0&&typeof c!="string")throw new Error(`edits[${i}].name: must be a text`);const h={...l===void 0?{}:{class:l},...c===void 0?{}:{name:c}};t.set(a,o===!0?{primitive:a,remove:o}:{primitive:a,...h})}),[...this.edits.keys()].forEach(n=>this.take(n,void 0)),t.forEach((n,i)=>this.take(i,n)),this.past=[...t].map(([n,i])=>[{primitive:n,before:void 0,after:i}]),this.undone=[]}take(e,t){t?this.edits.set(e,t):this.edits.delete(e);const n=this.numbers.get(e),{name:i,class:r}=this.facts.primitives[n];Object.assign(this.rows[n],{name:t?.name??i,class:t?.class??r,out:t?.remove===!0})}}function Rm(s,e){let t;try{t=JSON.parse(s)}catch{throw new Error("not JSON")}if(t?.format!=="underbrush-primitive-edits")throw new Error("not a list of edits of primitives");if(t.version!==1)throw new Error("version: must be 1");if(t.set!==void 0&&t.set!==e)throw new Error("set: the edits were made for another set, or for this one before it changed");return t.edits}const Ms=200,Cm=[["folder","Primitive"],["name","Name"],["class","Class"],["height_m","Height, m"],["width_m","Width, m"],["points","Points"],["elements","Elements"],["site","Site"],["season","Season"],["sensor","Sensor"],["license","Licence"]],Pm=new Intl.Collator("en",{numeric:!0}),Rr=["kept and thrown out","kept","thrown out"];class Lm{constructor(e){this.actions=e;const t=L("tr",{},L("th",{scope:"col"},"Picture"));for(const[o,l]of Cm){const c=L("th",{scope:"col","aria-sort":"none"},Ae(l,`Sort by ${l.toLowerCase()}`,()=>this.sortBy(o)));this.heads.set(o,c),t.append(c)}t.append(L("th",{scope:"col"},"Thrown out"));const n=L("table",{class:"grid","aria-label":"Primitives of the library"},L("thead",{},t),this.body),i=()=>{this.most=Ms,this.show()};[this.kind,this.fate].forEach(o=>o.addEventListener("change",i)),this.text.addEventListener("input",i);const r=L("div",{class:"filters",role:"group","aria-label":"All shown"},Ae("Throw out all shown","Throw out every primitive that the filters leave",()=>this.changeAll({out:!0})),Ae("Bring back all shown","Bring back every primitive that the filters leave",()=>this.changeAll({out:!1})),this.classOfAll,Ae("Relabel all shown","Give every primitive that the filters leave this class",()=>this.changeAll({class:this.classOfAll.value}))),a=Ae("×","Close the table (#)",()=>this.actions.close());a.setAttribute("aria-label","Close the table"),this.element.append(L("div",{class:"head"},this.heading,L("div",{class:"filters"},this.kind,this.fate,this.text),r,this.counted,a),L("div",{class:"scroll",tabindex:"0",role:"group","aria-label":"Table of the library"},n,this.more))}actions;element=L("section",{id:"library","aria-label":"Library",hidden:""});edits=null;pictures=e=>"";column="folder";down=!1;most=Ms;chosen=-1;heading=L("h2");kind=L("select",{"aria-label":"Class or kind"});fate=L("select",{"aria-label":"Kept or thrown out"},...Rr.map(e=>L("option",{value:e},e)));text=L("input",{type:"search",placeholder:"Search","aria-label":"Search in names, classes and origins"});classOfAll=L("select",{"aria-label":"Class of all shown"});counted=L("span",{class:"count",role:"status","aria-label":"Primitives shown"});heads=new Map;body=L("tbody");more=Ae("More","Show more rows",()=>{this.most+=Ms,this.show()});open(e,t,n){[this.edits,this.pictures,this.chosen,this.most]=[t,n,-1,Ms],this.heading.textContent=e;const{classes:i}=t.facts,r=[...new Set(i.map(a=>a.kind))];this.kind.replaceChildren(L("option",{value:""},"all classes"),...r.map(a=>L("option",{value:a},a==="patch"?"cells of patches":`all ${a}s`)),...i.map(a=>L("option",{value:a.name},a.name))),this.classOfAll.replaceChildren(...i.map(a=>L("option",{value:a.name},a.name))),this.show()}sortBy(e){this.down=this.column===e&&!this.down,this.column=e,this.show()}changeAll(e){const t=i=>e.out===void 0?!i.out&&i.class!==e.class:i.out!==e.out,n=this.sorted().filter(t);this.actions.change(n.map(i=>i.model),e)}sorted(){const{rows:e,facts:t}=this.edits,n=t.classes.map(c=>c.name),[i,r]=[this.kind.value,this.text.value.toLowerCase().split(/\s+/)],a=e.filter(c=>{const h=t.classes.find(d=>d.name===c.class)?.kind,u=[c.folder,c.name,c.class,c.set,c.site,c.season,c.sensor,c.license].join(" ").toLowerCase();return(i===""||i===c.class||i===h)&&(this.fate.value===Rr[0]||c.out===(this.fate.value===Rr[2]))&&r.every(d=>u.includes(d))}),{column:o}=this,l=(c,h)=>{if(o==="class")return n.indexOf(c.class)-n.indexOf(h.class);const[u,d]=[c[o],h[o]];return typeof u=="number"&&typeof d=="number"?u-d:Pm.compare(`${u}`,`${d}`)};return a.sort((c,h)=>(this.down?-1:1)*l(c,h)||c.model-h.model)}show(){if(!this.edits)return;for(const[o,l]of this.heads)l.setAttribute("aria-sort",o!==this.column?"none":this.down?"descending":"ascending");const e=document.activeElement,[t,n]=this.body.contains(e)?[e.dataset.control,e.dataset.model]:[],i=e?.closest("tr")?.nextElementSibling?.querySelector(`[data-control="${t}"]`)?.dataset.model,r=this.sorted();this.body.replaceChildren(...r.slice(0,this.most).map(o=>this.row(o))),this.more.hidden=r.length<=this.most;const a=o=>this.body.querySelector(`[data-control="${t}"][data-model="${o}"]`);t&&(a(n)??a(i))?.focus(),this.count(r.length)}count(e){const{rows:t}=this.edits,n=t.filter(i=>i.out).length;this.counted.textContent=`${e} of ${t.length} shown, ${n} thrown out`,$e.dataset.library=`${e} ${t.length} ${n}`}row(e){const{model:t,folder:n}=e,i=(g,S,m)=>(g.setAttribute("aria-label",`${m} ${n}`),Object.assign(g.dataset,{control:S,model:`${t}`}),g),r=L("img",{src:this.pictures(t),alt:"",loading:"lazy",width:"40",height:"40"}),a=i(Ae("","Show it in the view",()=>this.choose(t)),"show","Show");a.append(r);const o=i(L("input",{type:"text"}),"name","Name of");o.value=e.name,o.addEventListener("change",()=>{this.actions.change([t],{name:o.value.trim()}),o.value=e.name});const l=i(L("select",{},...this.edits.classesOf(t).map(g=>L("option",{value:g},g))),"class","Class of");l.value=e.class,l.addEventListener("change",()=>this.actions.change([t],{class:l.value})),[o,l].forEach(g=>g.disabled=e.out);const c=e.out?"Bring back":"Throw out",h=i(Ae(c,`${c} ${n}`,()=>this.actions.change([t],{out:!e.out})),"out",c),u=g=>L("td",{},g),d=(g,S=0)=>L("td",{class:"number"},g.toFixed(S)),f=L("tr",{},L("td",{},a),u(n),L("td",{},o),L("td",{},l),d(e.height_m,2),d(e.width_m,2),d(e.points),d(e.elements),...[e.site,e.season,e.sensor,e.license].map(u),L("td",{},h));return f.classList.toggle("out",e.out),f.classList.toggle("chosen",t===this.chosen),f.addEventListener("click",g=>{g.target.closest("button, input, select")||this.choose(t)}),f}choose(e){this.chosen=e,this.show(),this.actions.show(e)}toggle(e){const t=this.element.contains(document.activeElement);this.element.hidden=!e,t&&!e&&zt("view").focus()}}function Dm(s){const e=[];let t=0;for(const n of s){const i=encodeURIComponent(JSON.stringify(n)).length+3;i>t&&(e.push([]),t=rl),e.at(-1).push(n),t-=i}return e}class Nm{constructor(e,t,n){this.app=e,this.menu=t,this.jobs=n,this.table=new Lm({change:(a,o)=>this.change(()=>{const l=this.edits.change(a,o);l<a.length&&this.app.tell(`${l} primitives changed; ${a.length-l} may not become ${o.class}`)},o.name!==void 0),show:a=>this.look(a),close:()=>this.toggle()}),document.body.append(this.table.element);const i=L("input",{type:"file",accept:".json",hidden:"","aria-label":"List of edits of a library"});i.addEventListener("change",()=>{i.files?.[0]&&e.run(this.openList(i.files[0])),i.value=""});const r=(a,o,l)=>Ae(a,o,()=>e.run(l()));this.section=e.section("Library",L("div",{class:"buttons"},this.toggleButton,this.undoButton,this.redoButton),this.told,i,L("div",{class:"buttons"},Ae("Open edits","Open a list of edits of these primitives",()=>i.click()),...n?[r("Write edits","Write the edits to the folder for labels, for primitives merge --edits",()=>this.write()),r("Merge","Write the edits, and merge the set with them into a new library",()=>this.merge())]:[]),L("div",{role:"group","aria-label":"Command that applies the edits"},this.command)),this.table.element.addEventListener("keydown",a=>{Ir(a)&&(a.stopPropagation(),a.preventDefault(),this.step(nl(a)==="z"))}),e.onApply.push(()=>e.run(this.open())),e.onClose.push(()=>this.world?.showAlone(null)),this.show()}app;menu;jobs;world=null;edits=null;filed="[]";table;section;told=L("p",{class:"note","aria-label":"Edits of primitives"});command=L("code");toggleButton=Ae("Table","Show or hide the table of the primitives (#)",()=>this.toggle());undoButton=Ae("Undo","Take the last edit of a primitive back (<)",()=>this.step(!0));redoButton=Ae("Redo","Apply it again (>)",()=>this.step(!1));async open(){const e=[...this.app.viewer.worlds].find(n=>n.group.visible&&n.file.kind==="primitives")??null;if(e===this.world)return;this.world?.showAlone(null),[this.world,this.edits,this.filed]=[e,null,"[]"],this.command.textContent="";const t=e&&await ut(`primitives?${un({file:e.file.id})}`);if(e===this.world){if(e&&t){this.edits=new Am(t);const{library:n}=this.app.state;if(this.table.open(e.file.name,this.edits,i=>`./api/thumbnail?${un({file:e.file.id,model:`${i}`})}`),n?.file===e.file.id&&n.edits.length>0)try{this.edits.replace(n.edits)}catch(i){this.app.fail(i)}n?.file===e.file.id&&n.open&&this.table.toggle(!0)}else this.table.toggle(!1);this.show(),this.table.show()}}toggle(){if(!this.edits)return this.app.tell("Show a set of primitives first");this.table.toggle(this.table.element.hidden),this.table.element.hidden&&this.app.closeDetails(),this.show()}change(e,t=!1){try{e()}catch(n){this.app.fail(n)}t||this.table.show(),this.show()}step(e){const{edits:t}=this;t&&this.change(()=>e?t.undo():t.redo())}text(){return JSON.stringify(this.edits?.list()??[])}show(){const{edits:e,world:t}=this;this.section.hidden=!e;const n=!this.table.element.hidden;if(this.toggleButton.setAttribute("aria-pressed",`${n}`),!e||!t)return;const i=e.rows.filter(o=>o.out).length,r=e.list();this.undoButton.disabled=e.undos===0,this.redoButton.disabled=e.redos===0;const a=this.text()===this.filed?"":"; not written yet";this.told.textContent=`${e.rows.length} primitives, ${i} thrown out, ${r.length-i} changed${a}`,$e.dataset.primitiveEdits=`${r.length}`,this.app.state.library=r.length>0||n?{file:t.file.id,open:n,edits:r}:null,this.menu.keepLink()}look(e){const t=this.world.boxOf(e);this.world.showAlone(e),this.app.viewer.frameBox(t),this.app.viewer.mark(new Go(t,new Xe(15787074))),$e.dataset.primitive=this.edits.rows[e].folder}async openList(e){const{edits:t}=this;if(!t)throw new Error("Show a set of primitives first");if(!(![this.filed,"[]"].includes(this.text())&&!confirm("The edits so far were not written. Open others in their place?"))){try{t.replace(Rm(await e.text(),t.facts.set))}catch(n){throw new Error(`${e.name}: ${n.message}`)}this.filed=this.text(),this.table.show(),this.show(),this.app.tell(`Opened: ${e.name}`)}}async write(){const{edits:e,world:t}=this;if(!e||!t)throw new Error("Show a set of primitives first");if(e.list().length===0)throw new Error("There are no edits to write");const n=this.jobs.freshName("primitive-edits",".json"),i=this.jobs.freshName(t.file.name.replace(/^.*\//,"")),r=this.text(),a=Dm(e.list());let o="";for(const[c,h]of a.entries()){const u=c+1<a.length,d={file:t.file.id,name:n,set:e.facts.set,edits:JSON.stringify(h),more:u};({path:o}=await En("primitives/write",d))}this.filed=r;const l=un({verb:"primitives",primitives:`${t.file.id}`,edits:n,name:i});return this.command.textContent=(await ut(`jobs/command?${l}`)).command,this.show(),this.app.tell(`Written: ${o}`),{edits:n,name:i}}async merge(){const{world:e}=this,t=await this.write(),n=!this.table.element.hidden,i=await this.jobs.runAndShow("primitives",{primitives:e.file.id,...t});this.app.state.library={file:i,open:n,edits:[]},await this.menu.toggle(e.file,!1)}actions(){return[{key:"#",name:"library: show or hide the table",act:()=>this.toggle()},{key:"<",name:"library: undo",act:()=>this.step(!0)},{key:">",name:"library: redo",act:()=>this.step(!1)}]}}function Br(s){return s.map(e=>e.toFixed(3)).join(", ")}function gi(s,e){return L("div",{class:"head"},L("h2",{},s),Ae("×","Close (Escape)",e.close))}function Fm(s,e,t){const n=s.hit?`${At(s.range_m)} m`:s.inferred?"inferred miss":"miss",i=[["log",e.name],["row",`${s.row}`],["beam",`${s.beam}`],["range",n],["end",`${Br(s.end_m)} m`],["origin",`${Br(s.origin_m)} m`],["intensity",At(s.intensity)],["time",`${s.time_s.toFixed(6)} s`],["ring",`${s.ring}`],["scan",`${s.scan}`],["packet",`${s.packet}`]];s.echoes_m.length>1&&i.push(["echoes",s.echoes_m.map(l=>`${At(l)} m`).join(", ")]);for(const[l,c]of Object.entries(s.columns??{}))i.push([l,At(c)]);const r=t.worlds().map(l=>Ae(`Why did this beam end here? (${l.name})`,"Follow the beam (B)",()=>t.follow(s,e.id,l)));if(t.worlds().length===0)return[gi("Beam",t),ki(i)];const a=L("select",{},...["",...t.sensors].map(l=>L("option",{value:l},l||"the log's own")));a.value=t.sensor();const o=t.worlds().map(l=>Ae(`Waveform and echoes (${l.name})`,"What the sensor receives of this beam (;)",()=>t.receive(s,e.id,l,a.value)));return[gi("Beam",t),ki(i),...r,L("label",{class:"row"},"Sensor",a),...o]}function Im(s,e,t){const n=s.real_range_m===null?"a miss":`${At(s.real_range_m)} m`,i=s.simulated_range_m===null?"a miss":`${At(s.simulated_range_m)} m`,r=s.ends_by==="keyframe"?`${i}, from a keyframe of the model and not from its elements`:s.ends_by==="unknown space"?`${i}, in space that no beam of the model's log crossed`:s.ends_at===null?"no element stops it: a miss":`the ${s.met[s.ends_at]?.kind??"element"} no. ${s.ends_at+1} stops it at ${i}`,a=h=>h===0?"0":h<.001?h.toExponential(0):h.toFixed(3),o=s.met.map((h,u)=>[`${u+1}${u===s.ends_at?" ◀":""}`,h.range_m.toFixed(2),`${h.kind} ${h.index}`,h.class,a(h.p),a(h.draw),h.accepts?"stops":"passes",a(h.reach),`${h.hits}/${h.misses}`]),c=ks(["no.","range, m","element","class","p","draw","trial","reached by","hits/misses"],o);return c.classList.add("wide"),[gi("Why the beam ends",t),L("p",{},`Beam ${s.beam} in ${e.name}, seed ${s.seed}. Measured: ${n}. Simulated: ${r}. It meets ${s.met_in_all} elements; a beam passes all of them with probability ${At(s.miss_probability)}. An element stops the beam if its draw is below p.`),L("div",{class:"scroll",tabindex:"0"},c)]}function Um(s,e){if(s.target.kind!=="world")return[];const{world:t,instance:n,part:i}=s.target,r=t.facts.instances[n],a=t.facts.models[r.model],o=[["file",t.file.name],["model",a.name],["instance",`${n}, ${r.class}${r.moves?", moves":""}`],["element",i==="ellipsoid"?`ellipsoid ${s.part}`:`${i}, triangle ${s.part}`]],l=i==="ellipsoid"?t.ellipsoid(n,s.part):t.triangle(n,i,s.part);if(o.push(["p",At(l.p)],["hits",`${l.hits}`],["misses",`${l.misses}`]),i==="ellipsoid"){const c=t.ellipsoid(n,s.part);o.push(["class",t.facts.classes[c.label]??`${c.label}`],["deviations in x, y, z",`${c.semiAxes.map(At).join(", ")} m`])}if(s.place){const c=t.facts.origin_m,h=s.place.clone().sub(t.group.position).toArray();o.push(["place",`${Br(h.map((u,d)=>u+c[d]))} m`])}return[gi("Element",e),ki(o)]}async function Om(s,e){const t=await ut(`score?file=${s.id}`),n=Object.keys(t.models),i=t.models[n[0]],r=c=>c===null||typeof c=="number",o=Object.keys(i).filter(c=>r(i[c])).map(c=>[c,...n.map(h=>At(t.models[h][c]))]),l=[gi(s.name,e),L("div",{class:"scroll",tabindex:"0"},ks(["score",...n],o))];for(const c of["per_class","per_range"]){const h=i[c];if(!h||Object.keys(h).length===0)continue;const u=["beams","f1","packet_error_m","median_range_error_m"],d=Object.entries(h).map(([f,g])=>[f,...u.map(S=>At(g[S]))]);l.push(L("h3",{},c==="per_class"?`${n[0]}, by class`:`${n[0]}, by range (m)`),L("div",{class:"scroll",tabindex:"0"},ks(["part",...u],d)))}return l}const Bm={height:"Points by height, m",intensity:"Points by intensity",time:"Points by time, s",ring:"Points by ring",return:"Points by number of the return",class:"Points by class",file:"Points by file",instance:"Points by instance",error:"Points by error of the range, m","packet error":"Points by error of the packet, m"},km={p:"Elements by hit probability p",class:"Elements by class",height:"Elements by height, m"},Gm=[["#57b5e8","hit"],["#e69e00","miss"],["#f2cf80","inferred miss"]],zm="#d65e00",fl=s=>L("p",{class:"title"},s);function Wn(s,e){const t=e.map(([n,i])=>{const r=L("span",{class:"swatch"});return r.style.background=n,L("li",{},r,i)});return L("div",{},fl(s),L("ul",{},...t))}function Xn(s,e,t){const n=L("div",{class:"bar"});n.style.background=e;const i=t.filter(l=>typeof l=="number"),r=Math.max(...i)-Math.min(...i),a=r>0?Math.min(6,Math.max(0,1-Math.floor(Math.log10(r)))):2,o=t.map(l=>L("span",{},typeof l=="number"?`${Number(l.toFixed(a))}`:l));return L("div",{},fl(s),n,L("div",{class:"ends"},...o))}const Cr=(s,e)=>[s,(s+e)/2,e];class Hm{constructor(e){this.app=e,document.body.append(this.box)}app;box=L("section",{id:"legend","aria-label":"Legend"});beams=!1;show(){const{viewer:e,state:t}=this.app,n=[...e.clouds].filter(a=>a.group.visible),i=[...e.worlds].filter(a=>a.group.visible);for(const a of n)cn.add(a.octree.facts.labels.map(o=>o.number));const r=[];n.length>0&&r.push(...this.points(n)),i.length>0&&t.worlds!=="plain"&&r.push(this.elements()),this.beams&&r.push(Wn("Beams",Gm)),this.box.replaceChildren(...r),this.box.hidden=r.length===0||!t.legend}heights(){const{viewer:e,files:t}=this.app,n=t.origin?.z??0,{x:i,y:r}=e.display.uniforms.heights.value;return Cr(i+n,r+n)}points(e){const{state:t,files:n}=this.app,i=Bm[t.points],r=vs(t.map),a=e[0];if(t.points==="height")return[Xn(i,r,this.heights())];if(t.points==="intensity")return e.map(o=>{const l=e.length>1?`, ${n.file(o.octree.file).name}`:"";return Xn(`${i}${l}`,r,Cr(...o.painted.intensities))});if(t.points==="time")return[Xn(i,r,Cr(0,Math.max(...e.map(o=>o.painted.span))))];if(t.points==="ring")return[Xn(i,r,[0,Math.max(...e.map(o=>o.painted.rings))])];if(t.points==="error"||t.points==="packet error"){const o=vs(t.map,l=>l*l);return[Xn(i,o,[0,.5,"1 and more"]),Wn("",[[zm,"no hit in the other log"]])]}if(t.points==="return"){const o=Math.min(8,Math.max(...e.map(l=>l.octree.facts.most_echo)));return[Wn(i,Array.from({length:o},(l,c)=>[cn.css(c+1),`${c+1}`]))]}return t.points==="file"?[Wn(i,e.map(o=>[cn.css(o.octree.file+1),n.file(o.octree.file).name]))]:t.points==="instance"?[Wn(i,[[cn.css(0),"none; others by turns"]])]:[Wn(i,this.classes(a.marked??e.flatMap(o=>o.octree.facts.labels)))]}classes(e){const t=new Map(e.map(n=>[n.number,n.name]));return t.size===0?[[cn.css(0),"no classes"]]:[...t].map(([n,i])=>[cn.css(n),i])}elements(){const{state:e,viewer:t}=this.app,n=km[e.worlds];if(e.worlds==="p")return Xn(n,vs(e.elementMap),[0,.5,1]);if(e.worlds==="height")return Xn(n,vs(e.elementMap),this.heights());const i=new Map;for(const a of t.worlds)if(a.group.visible)for(const o of a.labels)i.set(o,a.facts.classes[o]??`${o}`);const r=[...i].sort((a,o)=>a[0]-o[0]).map(([a,o])=>[cn.css(a),o]);return Wn(n,[...r,["#9e8c73","meshes"]])}}const pl=["automatic","graphics card","processor"],Vm=`
  void main() { gl_Position = vec4(position.xy, 0.0, 1.0); }
`,Wm=`
  uniform sampler2D points;
  uniform sampler2D depths;
  uniform bool splatted;
  uniform int dome;
  /** Depth = planes.x - planes.y / distance. */
  uniform vec2 planes;
  float nearness(ivec2 at, float own) {
    float z = texelFetch(depths, at, 0).r;
    return z >= 1.0 ? own : planes.x - z;
  }
  float nearer(ivec2 at, ivec2 by, float own) {
    return max(0.0, nearness(at + by, own) + nearness(at - by, own) - 2.0 * own);
  }
  void main() {
    ivec2 at = ivec2(gl_FragCoord.xy);
    vec4 colour = texelFetch(points, at, 0);
    if (colour.a < 0.5) discard;
    float light = 1.0;
    float depth = 0.0;
    if (splatted) {
      depth = planes.x - planes.y * texelFetch(depths, at, 0).r;
    } else {
      depth = texelFetch(depths, at, 0).r;
      float own = planes.x - depth;
      float dark = dome > 0 ? nearer(at, ivec2(dome, 0), own) + nearer(at, ivec2(0, dome), own) : 0.0;
      light = max(${hl.toFixed(2)}, own / (own + ${(cl/2).toFixed(1)} * dark));
    }
    gl_FragDepth = depth;
    gl_FragColor = vec4(colour.rgb * light, 1.0);
  }
`,Xm=`
  varying vec2 at;
  void main() {
    at = 0.5 + 0.5 * position.xy;
    gl_Position = vec4(position.xy, 0.0, 1.0);
  }
`,$m=`
  uniform sampler2D points;
  varying vec2 at;
  void main() { gl_FragColor = texture2D(points, at); }
`;function qm(s){const e=s.getHex();return(4278190080|(e&255)<<16|e&65280|e>>16)>>>0}function Ym(s){const e=s.getExtension("WEBGL_debug_renderer_info"),t=String(s.getParameter(e?e.UNMASKED_RENDERER_WEBGL:s.RENDERER));return/swiftshader|llvmpipe|softpipe|software|basic render/i.test(t)}class Km{constructor(e,t){this.renderer=e,this.display=t,this.software=Ym(e.getContext()),this.target.depthTexture=new Zn(1,1);const n={points:{value:null},depths:{value:null},splatted:{value:!1},dome:{value:0},planes:{value:new Ye}};this.look=new pn({uniforms:n,vertexShader:Vm,fragmentShader:Wm,toneMapped:!1});const i={uniforms:{points:{value:null}},vertexShader:Xm,fragmentShader:$m};this.copy=new pn({...i,toneMapped:!1,depthTest:!1,depthWrite:!1});const r=new ht;r.setAttribute("position",new ct(new Float32Array([-1,-1,0,3,-1,0,-1,3,0]),3)),this.quad=new fn(r,this.look),this.quad.frustumCulled=!1,this.quad.renderOrder=5,this.quad.raycast=()=>{},this.quad.layers.set(tl)}renderer;display;quad;software;lighting=!0;drawer="automatic";splatter=new Xp;target=new Zt(1,1,{minFilter:1003,magFilter:1003});look;copy;deep=!1;size=new Ye;colours=null;nearness=null;get splats(){return this.drawer==="processor"||this.drawer==="automatic"&&this.software}begin(e,t,n){this.deep=t,this.renderer.getDrawingBufferSize(this.size);const{x:i,y:r}=this.size;this.quad.visible=!1,this.look.uniforms.dome.value=this.lighting?Math.max(1,Math.round(e/2)):0,this.splats?this.splatter.begin(i,r,t?0:qm(n)):this.target.setSize(i,r)}add(e,t,n,i){this.quad.visible||=n.length>0,this.splats?this.splat(t,n,i):this.render(e,t,i)}finish({near:e,far:t}){const{uniforms:n}=this.look;n.planes.value.set(t/(t-e),t*e/(t-e)),n.splatted.value=this.splats,this.quad.material=this.splats&&!this.deep?this.copy:this.look,this.splats?this.quad.visible&&this.upload():(n.points.value=this.target.texture,n.depths.value=this.target.depthTexture)}show(e,t){t.layers.mask=op,this.renderer.render(e,t),t.layers.mask=Bs}splat(e,t,n){const{splatter:i,display:r}=this,a=new Qe().multiplyMatrices(e.projectionMatrix,e.matrixWorldInverse),[o,l]=r.uniforms.sliceRange.value.toArray(),c=r.uniforms.sliceNormal.value.toArray().indexOf(1),h=o>-1e29||l<1e29?{axis:c,low:o,high:l}:null;for(const u of t){const d={times:u.times,slice:h};for(const f of u.batches())i.draw(f,a,n,Math.max(1,u.size),d)}}upload(){const{splatter:e,look:t}=this;this.lighting&&e.shade(t.uniforms.dome.value);const{width:n,height:i}=e;this.nearness?.image.data!==e.near&&(this.colours?.dispose(),this.nearness?.dispose(),this.colours=new Bi(new Uint8Array(e.colour.buffer),n,i,1023),this.nearness=new Bi(e.near,n,i,1028,1015)),this.colours.needsUpdate=!0,this.deep&&(this.nearness.needsUpdate=!0),t.uniforms.points.value=this.copy.uniforms.points.value=this.colours,t.uniforms.depths.value=this.nearness}render(e,t,n){const{renderer:i,target:r}=this,a=e.background;e.background=null,r.viewport.set(n.left,0,n.width,this.size.y),r.scissor.set(n.from,0,n.to-n.from,this.size.y),r.scissorTest=!0,t.layers.set(Yr),i.setRenderTarget(r),i.setClearColor(0,0),i.render(e,t),i.setRenderTarget(null),t.layers.mask=Bs,e.background=a}}function Zm(){return{eye:null,target:null,shown:null,points:"height",worlds:"p",map:"viridis",elementMap:"earth",size:2,sigmas:1,opaque:!1,lighting:!0,drawer:"automatic",legend:!0,slice:{on:!1,axis:"z",at:0,thickness:1},theme:"",edits:null,library:null}}function vo(s){return Array.isArray(s)&&s.length===3&&s.every(e=>Number.isFinite(e))}function Jm(s){const e=Zm();try{const t=JSON.parse(decodeURIComponent(s.replace(/^#/,""))||"{}");vo(t.eye)&&(e.eye=t.eye),vo(t.target)&&(e.target=t.target),Array.isArray(t.shown)&&(e.shown=t.shown.filter(r=>Number.isInteger(r)));const n=r=>{typeof t[r]==typeof e[r]&&(e[r]=t[r])};["size","sigmas","opaque","lighting","legend","theme"].forEach(n);const i=(r,a)=>{a.includes(t[r])&&(e[r]=t[r])};i("points",qr),i("worlds",qs),i("map",Os),i("elementMap",Os),i("drawer",pl),Number.isInteger(t.edits?.file)&&Array.isArray(t.edits?.list?.edits)&&(e.edits=t.edits),Number.isInteger(t.library?.file)&&Array.isArray(t.library?.edits)&&(e.library=t.library),t.slice&&typeof t.slice=="object"&&(e.slice={...e.slice,...t.slice})}catch{}return e}function Qm(s){const e=n=>Math.round(n*1e3)/1e3,t={...s,slice:{...s.slice,at:e(s.slice.at)},eye:s.eye?.map(e)??null,target:s.target?.map(e)??null};return`#${encodeURIComponent(JSON.stringify(t))}`}const jm=["0.1","0.25","0.5","1","2","5"];async function eg(s){const e=new Float32Array((await bn(`trajectory?file=${s}`)).slice(4)),t=e.length/4,n=new Float32Array(t),i=new Float32Array(3*t);for(let h=0;h<t;++h)n[h]=e[4*h],i.set(e.subarray(4*h+1,4*h+4),3*h);const r=new Ot,a=new ht;a.setAttribute("position",new ct(i,3));const o=new ht;o.setAttribute("position",new ct(new Float32Array(3),3));const l=new Hi(o,new Wr({color:15787074,size:10,sizeAttenuation:!1,depthTest:!1})),c=new Hs(a,new Si({color:15113984}));return[c,l].forEach(h=>{h.frustumCulled=!1,h.renderOrder=9}),r.add(c,l),{times:n,places:i,group:r,dot:l}}function xo(s,e){const{times:t,places:n,dot:i}=s;let r=t.findIndex(h=>h>=e);r<0&&(r=t.length-1);const a=Math.max(0,r-1),o=t[r]-t[a],l=o>0?Math.min(1,Math.max(0,(e-t[a])/o)):1,c=i.geometry.getAttribute("position");for(let h=0;h<3;++h){const[u,d]=[n[3*a+h],n[3*r+h]];c.array[h]=u+l*(d-u)}c.needsUpdate=!0}class tg{constructor(e){this.app=e,this.timeSlider=Kt("Time, s",[0,1,.01],1,n=>this.set(n,this.window)),this.windowSlider=Kt("and before, s",[0,1,.01],1,n=>this.set(this.time,n)),this.windowSlider.row.title="Points of so many seconds before the time are shown",this.pathBox=In("Path of the sensor",!1,()=>e.run(this.showPaths()));const t=dn("Speed",jm,"1",n=>this.speed=Number(n));t.row.title="Seconds of the log that pass in a second",this.rows=[this.timeSlider.row,this.windowSlider.row,L("div",{class:"buttons"},this.playButton),t.row,this.pathBox.row]}app;rows;onTime=[];first=0;span=0;speed=1;time=0;window=0;timeSlider;windowSlider;pathBox;playButton=Ae("Play","Play or stop the time (\\)",()=>this.play());paths=new Map;playing=0;last=0;shown(){return[Math.max(0,this.time-this.window),this.time]}setSpan(e,t){e===this.span&&t===this.first||(this.span=e,this.first=t,this.timeSlider.limits(0,e),this.windowSlider.limits(0,e),this.set(e,e))}set(e,t){this.time=e,this.window=t,this.timeSlider.set(e),this.windowSlider.set(t);const[n,i]=this.shown();for(const r of this.app.viewer.clouds){const{first_time_s:a,last_time_s:o}=r.octree.facts;r.setTimes(n-.001,i>=o-a-.001?o-a+1:i)}this.paths.forEach(r=>xo(r,e)),this.onTime.forEach(r=>r(e)),$e.dataset.time=e.toFixed(3),this.app.viewer.draw()}showScan({runs:e,facts:t},n){const[i,r]=[t.first_time_s,t.last_time_s],a=e.findIndex(h=>h.scan===n);if(a<0)return this.set(r-i,r-i);const o=e.slice(a).find(h=>h.scan!==n),[l,c]=[e[a].time,o?.time??r];this.set(c-i,c-l)}scanShown({runs:e,facts:t}){return(e.filter(i=>i.time-t.first_time_s<this.time-1e-6).at(-1)??e[0])?.scan??0}async showPaths(){const{files:e,viewer:t}=this.app,n=this.pathBox.on();for(const[i,r]of e.clouds){if(n&&r.group.visible&&!this.paths.has(i)){const o=await eg(i);o.group.position.copy(r.group.position),xo(o,this.time),this.paths.set(i,o),t.overlays.add(o.group)}const a=this.paths.get(i);a&&(a.group.visible=n&&r.group.visible)}$e.dataset.paths=String([...this.paths.values()].filter(i=>i.group.visible).length),t.draw()}play(){if(this.playing){cancelAnimationFrame(this.playing),this.playing=0,this.playButton.textContent="Play";return}this.window>=this.span&&this.set(0,Math.max(this.span/20,Math.min(this.span,.2))),this.time>=this.span&&this.set(0,this.window),this.playButton.textContent="Stop",this.last=performance.now();const e=t=>{this.set(Math.min(this.span,this.time+this.speed*(t-this.last)/1e3),this.window),this.last=t,this.time>=this.span?this.play():this.playing=requestAnimationFrame(e)};this.playing=requestAnimationFrame(e)}actions(){return[{key:"\\",name:"play or stop the time",act:()=>this.play()},{key:"'",name:"path of the sensor",act:()=>{this.pathBox.set(!this.pathBox.on()),this.app.run(this.showPaths())}}]}}class ng{constructor(e,t){this.app=e,this.actions=t;const{state:n,viewer:i}=e,r=M=>A=>{n[M]=A,e.apply()};this.pointMode=dn("Points by",qr,n.points,r("points")),this.worldMode=dn("Elements by",qs,n.worlds,r("worlds")),this.legend=new Hm(e);const a=dn("Colours",Os,n.map,r("map")),o=dn("Their colours",Os,n.elementMap,r("elementMap")),l=Kt("Point size",[1,8,.5],n.size,r("size")),c=Kt("Ellipsoids, σ",[.5,3.5,.1],n.sigmas,r("sigmas")),h=In("Ellipsoids opaque (else p of their pixels)",n.opaque,r("opaque")),u=In("Eye-dome lighting of points",n.lighting,r("lighting")),d=In("Legend",n.legend,r("legend")),f=dn("Drawn by",pl,n.drawer,r("drawer"));f.row.title="What draws the points; automatic takes the processor where there is no graphics card";const g=Kt("Points, millions",[.1,10,.1],i.budget/1e6,M=>{i.budget=M*1e6,i.draw()}),S=M=>A=>{n.slice[M]=A,M==="axis"&&this.limits(),e.apply()};this.sliceOn=In("Slice",n.slice.on,S("on"));const m=dn("along",["x","y","z"],n.slice.axis,S("axis"));this.sliceAt=Kt("at, m",[-100,100,.1],n.slice.at,S("at"));const p=Kt("thick, m",[.05,10,.05],n.slice.thickness,S("thickness"));this.beamBox.addEventListener("change",()=>e.run(this.showBeams())),this.time=new tg(e),e.list.files.forEach(M=>this.addFile(M)),e.section("Files",this.fileRows,...e.list.notes.map(M=>L("p",{class:"note"},M))),e.section("Display",...[this.pointMode,a,l,u,g,f].map(M=>M.row),...[this.worldMode,o,c,h,d].map(M=>M.row)),e.section("Slice",...[this.sliceOn,m,this.sliceAt,p].map(M=>M.row)),e.section("Beams and time",this.beamBox,...this.time.rows),e.onApply.push(()=>this.apply())}app;actions;pointMode;worldMode;sliceOn;sliceAt;restoring=!0;movingTimes=()=>null;beamBox=L("select",{"aria-label":"Beams of a scan"});time;legend;fileBoxes=new Map;fileRows=L("div");linkTimer=0;addFile(e){const{app:t}=this,n=In(`${e.name} (${e.kind})`,t.shown.has(e.id),i=>t.run(this.toggle(e,i)));this.fileBoxes.set(e.id,n),this.fileRows.append(n.row)}async toggle(e,t){const{app:n}=this;if(e.kind==="score"){t?n.showDetails(await Om(e,this.actions)):n.closeDetails();return}t?n.shown.add(e.id):n.shown.delete(e.id),this.fileBoxes.get(e.id)?.set(t);const i=n.viewer.clouds.size+n.viewer.worlds.size===0;await n.files.show(e.id,t),t&&(i||e.kind==="primitives"&&!this.restoring)&&n.frame(),this.limits(),n.apply()}shownTimes(){return this.time.shown()}keepLink(){if(this.restoring)return;const{app:e}=this;clearTimeout(this.linkTimer),$e.dataset.link="old",this.linkTimer=window.setTimeout(()=>{const t=e.files.origin??new D,{camera:n,navigation:i}=e.viewer,r={...e.state,eye:n.position.clone().add(t).toArray(),target:i.target.clone().add(t).toArray(),shown:[...e.shown].sort((a,o)=>a-o),slice:{...e.state.slice,at:e.state.slice.at+t[e.state.slice.axis]}};history.replaceState(null,"",Qm(r)),$e.dataset.link="new"},300)}apply(){const{state:e,viewer:t}=this.app;t.display.setMap(e.elementMap),t.display.setSlice(e.slice),t.points.lighting=e.lighting,t.points.drawer=e.drawer,this.legend.show();const[n,i]=t.display.uniforms.heights.value.toArray();for(const r of t.clouds)r.setPaint(e.points,e.map,[n,i]),r.setSize(e.size*t.pixelRatio);for(const r of t.worlds)r.setMode(e.worlds),r.setRadius(e.sigmas),r.setOpaque(e.opaque);$e.dataset.theme=e.theme||(window.matchMedia("(prefers-color-scheme: light)").matches?"light":"dark"),t.setBackground(getComputedStyle($e).getPropertyValue("--view").trim()),this.keepLink()}async showBeams(){const[e,t]=this.beamBox.value.split(" ").map(Number),{app:n}=this;n.tell(await n.files.showBeams(e??0,this.beamBox.value===""?null:t)),this.legend.beams=this.beamBox.value!=="",this.legend.show(),$e.dataset.beams=n.status.textContent??""}limits(){const{viewer:e,files:t,state:n}=this.app,i=e.bounds();this.sliceAt.limits(i.min[n.slice.axis],i.max[n.slice.axis]);let r=0,a=1/0;const o=[L("option",{value:""},"no beams")];for(const[h,u]of t.clouds){const d=u.octree.facts;r=Math.max(r,d.last_time_s-d.first_time_s),a=Math.min(a,d.first_time_s),u.octree.runs.slice(0,2e3).forEach((f,g)=>{const S=`${t.file(h).name}: scan ${f.scan}, ${(f.time-d.first_time_s).toFixed(2)} s`;o.push(L("option",{value:`${h} ${g}`},S))})}const l=t.clouds.size===0?this.movingTimes():null;l?this.time.setSpan(l[1]-l[0],l[0]):this.time.setSpan(r,Number.isFinite(a)?a:0),this.app.run(this.time.showPaths());const c=this.beamBox.value;this.beamBox.replaceChildren(...o),this.beamBox.value=c}}const ig="http://www.w3.org/2000/svg",[ws,di,Li,ys]=[420,170,34,24];function Fn(s,e,t=""){const n=document.createElementNS(ig,s);for(const[i,r]of Object.entries(e))n.setAttribute(i,`${r}`);return n.textContent=t,n}function sg(s,e){const t=[...s.range_m,...s.echoes.map(d=>d.range_m),...e===null?[]:[e]],[n,i]=t.length>0?[Math.min(...t)-.5,Math.max(...t)+.5]:[0,1],r=Math.max(2*s.threshold,...s.signal)*1.05,a=d=>Li+(d-n)/(i-n)*(ws-Li-6),o=d=>(di-ys)*(1-Math.max(d,0)/r),l=Fn("svg",{viewBox:`0 0 ${ws} ${di}`,class:"waveform",role:"img","aria-label":"Waveform over range"}),c=s.range_m.length>1?s.range_m[1]-s.range_m[0]:1;let h="";s.range_m.forEach((d,f)=>{const g=f===0||d-s.range_m[f-1]>1.5*c;h+=`${g?"M":"L"}${a(d).toFixed(1)} ${o(s.signal[f]).toFixed(1)}`});const u=o(s.threshold);l.append(Fn("path",{d:`M${Li} ${u}H${ws}`,class:"threshold"})),e!==null&&l.append(Fn("path",{d:`M${a(e)} 0V${di-ys}`,class:"measured"})),s.echoes.forEach(d=>l.append(Fn("path",{d:`M${a(d.range_m)} 0V${di-ys}`,class:"echo"}))),l.append(Fn("path",{d:h,class:"signal"})),l.append(Fn("path",{d:`M${Li} 0V${di-ys}H${ws}`,class:"axis"}));for(let d=0;d<=4;++d){const f=n+d/4*(i-n);l.append(Fn("text",{x:a(f),y:di-8,"text-anchor":d===4?"end":"middle"},f.toFixed(1)))}for(const d of[0,s.threshold,r/1.05])l.append(Fn("text",{x:Li-3,y:Math.max(9,o(d)+3),"text-anchor":"end"},At(Math.round(d))));return l}function rg(s,e,t,n){const i=[...new Set(s.echoes.flatMap(o=>Object.keys(o)))],r=s.echoes.map(o=>i.map(l=>At(o[l]))),a=e.echoes_m.length>0?`${e.echoes_m.map(At).join(", ")} m`:"a miss";return[gi("Waveform",n),L("p",{},`Beam ${e.beam} in ${t.name} as ${s.sensor} receives it, ${s.sub_rays} sub-rays, seed ${s.seed}. Measured (red): ${a}. Dashed: threshold; yellow: echoes. The signal is in units of the noise in the dark.`),L("figure",{},sg(s,e.range_m),L("figcaption",{},"Signal over range, m")),s.echoes.length>0?L("div",{class:"scroll",tabindex:"0"},ks(i,r)):L("p",{},"The instrument reports no echo.")]}class ag{constructor(e){this.app=e,this.actions={worlds:()=>[...e.of("model"),...e.of("scene")],follow:(t,n,i)=>e.run(this.follow(t,n,i)),receive:(t,n,i,r)=>e.run(this.receive(t,n,i,r)),sensors:e.list.sensors,sensor:()=>this.sensor,close:()=>e.closeDetails()},e.onClose.push(()=>{this.picked=null,this.measuring=null})}app;actions;onBeam=[];picked=null;measuring=null;sensor="";followPicked(){const e=this.actions.worlds()[0];this.picked&&e&&this.actions.follow(this.picked.beam,this.picked.file,e)}receivePicked(){const e=this.actions.worlds()[0];this.picked&&e&&this.actions.receive(this.picked.beam,this.picked.file,e,this.sensor)}toggleMeasure(){this.measuring=this.measuring?null:[],this.app.tell(this.measuring?"Measure: pick the first place":""),this.measuring||this.app.viewer.mark()}async pick(e){if($e.dataset.picked=e?`${e.target.kind} ${e.part}`:"nothing",this.measuring)return this.measure(e?.place??null);if(!e)return this.app.closeDetails();try{e.target.kind==="point"?await this.showBeam(e.target.cloud.octree.file,e.part):e.target.kind==="beam"?await this.showBeam(e.target.file,e.part):this.app.showDetails(Um(e,this.actions))}catch(t){this.app.fail(t)}}async follow(e,t,n){const{app:i}=this,r=await ut(`trace?file=${t}&row=${e.row}&world=${n.id}&seed=${i.list.seed}`);i.viewer.mark(Tr(e,r,i.files.origin)),i.showDetails(Im(r,n,this.actions))}async receive(e,t,n,i){const{app:r}=this;this.sensor=i;const a=r.list.seed,o=await ut(`echoes?${un({file:t,row:e.row,world:n.id,sensor:i,seed:a})}`);r.viewer.mark(Tr(e,null,r.files.origin,o.echoes.map(l=>l.range_m))),r.showDetails(rg(o,e,n,this.actions))}async showBeam(e,t){const{app:n}=this,i=await ut(`beam?file=${e}&row=${t}`);this.picked={beam:i,file:e},n.viewer.mark(Tr(i,null,n.files.origin)),n.showDetails(Fm(i,n.files.file(e),this.actions)),this.onBeam.forEach(r=>r(e,t))}measure(e){const{app:t}=this;if(!e||!this.measuring)return;this.measuring.push(e);const[n,i]=this.measuring;if(!n||!i){t.tell("Measure: pick the second place");return}const r=i.clone().sub(n);t.viewer.mark(t.viewer.measured(n,i)),t.tell(`Distance ${At(r.length())} m, level ${At(Math.hypot(r.x,r.y))} m, height ${At(r.z)} m`),$e.dataset.measured=String(r.length()),this.measuring=[]}}const So=[{name:"above",right:[0,1],up:[1,1],back:[2,1]},{name:"the side",right:[0,1],up:[2,1],back:[1,-1]},{name:"the front",right:[1,1],up:[2,1],back:[0,1]}],Mo=180,bs=130,Di=10;function Es(s,[e,t]){return new D().setComponent(e,t).applyAxisAngle(new D(0,0,1),s.yaw)}class og{constructor(e,t){this.viewer=e,this.changed=t,So.forEach((n,i)=>{const r=L("div",{class:"outline"}),a=L("div",{class:"pane",title:`The box from ${n.name}: drag edges, the middle, or outside to turn`},r);a.addEventListener("pointerdown",l=>this.down(l,i)),a.addEventListener("pointermove",l=>this.move(l)),a.addEventListener("pointerup",()=>this.up()),this.frame.append(a);const o={camera:new Bo,element:a};this.panes.push({view:n,pane:a,outline:r,inset:o})}),document.body.append(this.frame)}viewer;changed;frame=L("div",{id:"box-views",hidden:""});panes=[];box=null;drag=null;show(e){this.box=e,this.frame.hidden=e===null,this.viewer.insets=e?this.panes.map(t=>t.inset):[],e&&this.place(e),this.viewer.draw()}half(e){const t=e.max.clone().sub(e.min);return Math.max(1,.9*Math.max(t.x,t.y,t.z))}place(e){const t=new D(0,0,1),n=e.min.clone().add(e.max).multiplyScalar(.5).applyAxisAngle(t,e.yaw).add(e.position),i=this.half(e),r=e.max.clone().sub(e.min);for(const{view:a,outline:o,inset:l}of this.panes){const c=l.camera,h=Mo/bs;[c.left,c.right,c.top,c.bottom]=[-i*h,i*h,i,-i];const u=Es(e,a.back);c.near=.01,c.far=40*i,c.position.copy(n).addScaledVector(u,20*i),c.up.copy(Es(e,a.up)),c.lookAt(n),c.updateProjectionMatrix(),c.updateMatrixWorld();const d=bs/(2*i),[f,g]=[r.getComponent(a.right[0])*d,r.getComponent(a.up[0])*d];o.style.width=`${f}px`,o.style.height=`${g}px`,o.style.left=`${(Mo-f)/2}px`,o.style.top=`${(bs-g)/2}px`}}down(e,t){if(!this.box)return;const{pane:n,outline:i}=this.panes[t];n.setPointerCapture(e.pointerId);const r=i.getBoundingClientRect(),a=(h,u)=>Math.abs(h-u)<Di;let o=a(e.clientX,r.left)?"l":a(e.clientX,r.right)?"r":"";o+=a(e.clientY,r.top)?"t":a(e.clientY,r.bottom)?"b":"",e.clientX>r.left-Di&&e.clientX<r.right+Di&&e.clientY>r.top-Di&&e.clientY<r.bottom+Di||(o="turn");const c={...this.box,position:this.box.position.clone(),min:this.box.min.clone(),max:this.box.max.clone()};this.drag={view:t,x:e.clientX,y:e.clientY,start:c,edges:o,perPixel:2*this.half(this.box)/bs}}move(e){if(!this.drag)return;const{view:t,x:n,y:i,start:r,edges:a,perPixel:o}=this.drag,{right:l,up:c}=So[t],h=(e.clientX-n)*o*l[1],u=(i-e.clientY)*o*c[1],d={position:r.position.clone(),yaw:r.yaw,min:r.min.clone(),max:r.max.clone()};if(a==="turn")t===0&&(d.yaw=r.yaw+(e.clientX-n)*.01);else if(a==="")d.position.addScaledVector(Es(r,[l[0],1]),h).addScaledVector(Es(r,[c[0],1]),u);else{const f=(g,S,m)=>g.setComponent(S,g.getComponent(S)+m);if(a.includes("l")&&f(d.min,l[0],h),a.includes("r")&&f(d.max,l[0],h),a.includes("t")&&f(d.max,c[0],u),a.includes("b")&&f(d.min,c[0],u),d.max.clone().sub(d.min).toArray().some(g=>g<.05))return}this.box=d,this.changed(d,!1)}up(){this.drag&&this.box&&(this.changed(this.box,!0),this.place(this.box)),this.drag=null}}const lg=/shrub|tree/,wo=["car","van","truck","cyclist","pedestrian","other"];class cg{constructor(e,t){this.app=e,this.time=t,this.views=new og(e.viewer,(i,r)=>this.dragged(i,r)),e.viewer.add(this.group),this.list.addEventListener("change",()=>this.goTo(Number(this.list.value))),t.onTime.push(()=>this.draw(this.boxes)),this.classes.addEventListener("change",()=>this.alter(i=>i.class=this.classes.value));const n=["x","y","z","turn, °","long","wide","high"].map((i,r)=>{const a=L("input",{type:"number",step:r===3?"5":"0.1"});return a.addEventListener("change",()=>this.typed()),this.numbers.push(a),L("label",{class:"row number"},i,a)});this.element=L("div",{},this.list,L("label",{class:"row"},"Class",this.classes),...n,this.buttons())}app;time;document=null;chosen=0;group=new Ot;views;list=L("select",{"aria-label":"Boxes",size:"4"});classes=L("select");numbers=[];element;buttons(){return L("div",{class:"buttons"},Ae("New box","A box at the target of the camera",()=>this.app.run(this.addHere())),Ae("Turn","Turn by 15°",()=>this.alter(e=>e.yaw_rad+=Math.PI/12)),Ae("To the ground","Drop the box to the ground",()=>this.alter(e=>this.drop(e))),Ae("Copy","Copy the box beside itself",()=>this.app.run(this.copy())),Ae("Delete","Delete the box",()=>this.app.run(this.remove())),Ae("Track","Make the box the first one of something that moves, in the scan that is shown",()=>this.beginTrack()),Ae("Scan before","The box of the track in the scan before, carried there if it has none",()=>this.app.run(this.carry(-1))),Ae("Next scan","The box of the track in the next scan, carried there if it has none",()=>this.app.run(this.carry(1))))}async open(e,t){this.document=e===null?null:t??new pi(e,null,()=>this.show()),this.document&&!this.document.state&&await this.document.open(),this.show()}get boxes(){return this.document?.state?.boxes??[]}origin(){return this.app.files.origin??new D}choose(e){this.chosen=e,this.show()}current(){return this.boxes.find(e=>e.number===this.chosen)}async add(e,t=0){if(!this.document)throw new Error("Choose a model or a log for boxes first");const n=await this.document.send("box",{value:JSON.stringify(e),stroke:t},!0);this.choose(n.number)}addHere(){const e=this.app.viewer.navigation.target.clone().add(this.origin()),t={class:"medium_tree",position_m:[e.x,e.y,e.z],yaw_rad:0,min_m:[-1,-1,0],max_m:[1,1,3]};return this.drop(t),this.add(t)}async copy(){const e=this.current();if(!e)return;const{number:t,...n}=structuredClone(e);n.position_m[0]+=e.max_m[0]-e.min_m[0]+.5,this.drop(n),await this.add(n)}get octree(){return this.document?.cloud?.octree??null}goTo(e){this.choose(e);const t=this.current();t?.scan!==void 0&&this.octree&&this.time.showScan(this.octree,t.scan)}beginTrack(){const{octree:e}=this;if(!e)return this.app.tell("Tracks are of a log: choose one for boxes");this.alter(t=>{t.track===void 0&&(t.track=1+Math.max(0,...this.boxes.map(n=>n.track??0)),t.scan=this.time.scanShown(e),wo.includes(t.class)||(t.class="car"),this.time.showScan(e,t.scan))})}async carry(e){const t=this.current();if(!t||t.track===void 0||!this.octree)throw new Error("Choose a box of a track first");const n=[...new Set(this.octree.runs.map(u=>u.scan))],i=n.indexOf(t.scan),r=n[i+e];if(r===void 0)throw new Error("There is no such scan");const a=u=>this.boxes.find(d=>d.track===t.track&&d.scan===u),o=a(r);if(o)return this.goTo(o.number);const{number:l,...c}=structuredClone(t),h=a(n[i-e]);if(h){c.position_m=c.position_m.map((d,f)=>Math.round((2*d-h.position_m[f])*1e3)/1e3);const u=t.yaw_rad-h.yaw_rad;c.yaw_rad+=Math.atan2(Math.sin(u),Math.cos(u))}await this.add({...c,scan:r}),this.time.showScan(this.octree,r)}async remove(){this.chosen&&await this.document?.send("box",{number:this.chosen},!0)}drop(e){const t=new D(...e.position_m).sub(this.origin()),n=this.app.viewer.groundAt(t.x,t.y);n!==null&&(e.position_m[2]=n+this.origin().z)}alter(e){const t=this.current();if(!t||!this.document)return;const n=structuredClone(t);e(n);const{number:i,...r}=n;this.app.run(this.document.send("box",{number:i,value:JSON.stringify(r)},!0))}typed(){const[e,t,n,i,r,a,o]=this.numbers.map(l=>Number(l.value));this.alter(l=>{l.position_m=[e,t,n],l.yaw_rad=i*Math.PI/180;const c=[r,a,o];for(const h of[0,1,2]){const u=l.max_m[h]-l.min_m[h];Math.abs(u-c[h])<.001||(h<2&&(l.min_m[h]-=(c[h]-u)/2),l.max_m[h]=l.min_m[h]+c[h])}})}sceneBox(e){return{position:new D(...e.position_m).sub(this.origin()),yaw:e.yaw_rad,min:new D(...e.min_m),max:new D(...e.max_m)}}dragged(e,t){const n=this.current();if(!n)return;const i=a=>a.toArray().map(o=>Math.round(o*1e3)/1e3),r={...n,position_m:i(e.position.clone().add(this.origin())),yaw_rad:Math.round(e.yaw*1e5)/1e5,min_m:i(e.min),max_m:i(e.max)};t?this.alter(a=>Object.assign(a,r)):this.draw(this.boxes.map(a=>a.number===n.number?r:a))}draw(e){this.group.children.slice().forEach(n=>n.removeFromParent());const t=this.octree&&this.time.scanShown(this.octree);for(const n of e){if(n.scan!==void 0&&n.scan!==t)continue;const i=this.sceneBox(n),r=new Ot;r.position.copy(i.position),r.rotation.z=i.yaw,r.add(new Go(new vt(i.min,i.max),new Xe(n.number===this.chosen?15787074:5682409))),this.group.add(r)}this.app.viewer.draw()}show(){const{boxes:e}=this;this.current()||(this.chosen=e.at(-1)?.number??0);const t=this.current()?.track!==void 0,n=(this.document?.state?.classes??[]).map(o=>o.name).filter(o=>lg.test(o)),i=t?wo:n;this.classes.dataset.names!==i.join()&&(this.classes.dataset.names=i.join(),this.classes.replaceChildren(...i.map(o=>L("option",{value:o},o))));const r=o=>o.track===void 0?"":`, track ${o.track} in scan ${o.scan}`;this.list.replaceChildren(...e.map(o=>L("option",{value:`${o.number}`},`${o.number} ${o.class}${r(o)}`))),this.list.value=`${this.chosen}`;const a=this.current();if(a){this.classes.value=a.class;const o=[0,1,2].map(l=>a.max_m[l]-a.min_m[l]);[...a.position_m,a.yaw_rad*180/Math.PI,...o].forEach((l,c)=>this.numbers[c].value=`${Math.round(l*1e3)/1e3}`)}this.views.show(a?this.sceneBox(a):null),$e.dataset.boxes=`${e.length}`,this.draw(e)}condition(){const e=this.current();if(!e)return null;const t=this.sceneBox(e),n=t.min.clone().add(t.max).multiplyScalar(.5);return n.applyAxisAngle(new D(0,0,1),t.yaw).add(t.position).add(this.origin()),[...n.toArray(),...t.max.clone().sub(t.min).toArray(),t.yaw]}}class hg{constructor(e,t,n,i,r){this.app=e,this.labeller=t,this.jobs=n,this.workflow=i,this.boxes=new cg(e,r),this.target.addEventListener("change",()=>e.run(this.openBoxes()));const a=Kt("Scatter, m",[.5,20,.5],this.spacing,l=>this.spacing=l);e.section("Boxes and placing",this.target,this.boxes.element,L("div",{class:"buttons"},Ae("Label inside","Give the class to the points in the box",()=>this.labelInside()),Ae("Primitives","Show the primitives of the chosen set",()=>e.run(this.showGallery())),Ae("Compose","Compose a scene of the boxes with the chosen primitives",()=>e.run(this.compose())),Ae("Tracks","Write the boxes of tracks as lists of objects, for actors --boxes",()=>e.run(this.writeTracks())),Ae("Learn actors","Learn what moves in the log from the boxes of tracks",()=>e.run(this.learnActors()))),a.row,this.gallery);const o=e.viewer.canvas;o.addEventListener("dragover",l=>l.preventDefault()),o.addEventListener("drop",l=>{l.preventDefault();const c=Number(l.dataTransfer?.getData("text/x-primitive")??"x");Number.isInteger(c)&&e.run(this.put(c,l.offsetX,l.offsetY))}),t.intercept=l=>this.scatter(l),t.onChange.push(()=>{this.boxes.document===t.labelled&&this.boxes.show()}),n.onFiles.push(()=>this.listTargets()),e.onClose.push(()=>this.scattered=-1),this.listTargets()}app;labeller;jobs;workflow;boxes;target=L("select",{"aria-label":"File for boxes"});gallery=L("div",{class:"gallery",role:"group","aria-label":"Primitives"});facts=null;set=-1;scattered=-1;spacing=3;listTargets(){const e=this.target.value;this.target.replaceChildren(L("option",{value:""},"choose a model or log for boxes"),...[...this.app.of("model"),...this.app.of("log")].map(t=>L("option",{value:`${t.id}`},t.name))),this.target.value=e}async openBoxes(){const e=this.target.value===""?null:Number(this.target.value);e!==null&&!this.app.shown.has(e)&&await this.workflow.showFile(e),e!==null&&this.app.files.file(e).kind==="log"&&this.labeller.labelled?.file!==e&&await this.labeller.open(e);const{labelled:t}=this.labeller;await this.boxes.open(e,t?.file===e?t:null),e!==null&&this.app.files.file(e).kind==="model"&&this.workflow.model.set(e)}labelInside(){const e=this.boxes.condition();if(!e||!this.labeller.labelled){this.app.tell("Choose a box, and a log to label");return}this.labeller.change({box:e},"box")}async showGallery(){this.set=this.workflow.set.id,this.facts=await ut(`world?file=${this.set}`),this.gallery.replaceChildren(...this.facts.models.slice(0,200).map((e,t)=>{const n=L("img",{src:`./api/thumbnail?file=${this.set}&model=${t}`,alt:"",loading:"lazy",width:"56"}),i=L("button",{type:"button",draggable:"true",title:`${e.name}: drag into the view, or click for the middle of it; Shift + click, then draw with the brush, scatters`},n,L("span",{},e.name));return i.addEventListener("dragstart",r=>r.dataTransfer?.setData("text/x-primitive",`${t}`)),i.addEventListener("click",r=>r.shiftKey?this.beginScatter(t):this.app.run(this.putInMiddle(t))),i}))}putInMiddle(e){return this.put(e,...this.app.viewer.middle)}async put(e,t,n,i=0,r=0){const a=this.app.viewer.groundUnder(t,n);if(!a)throw new Error("There is no ground there: show a model with a ground");await this.putAt(e,a,i,r)}async putAt(e,t,n,i){const r=this.facts.models[e],a=t.clone().add(this.app.files.origin);await this.boxes.add({class:r.class,position_m:[a.x,a.y,a.z].map(o=>Math.round(o*1e3)/1e3),yaw_rad:n,min_m:r.box_m.min,max_m:r.box_m.max,primitive:{file:this.set,model:e}},i)}beginScatter(e){this.scattered=e,this.labeller.tools.take("brush"),this.app.tell("Draw with the brush where the primitive shall stand; Escape ends")}scatter(e){if(this.scattered<0||e.radius===0)return!1;const t=()=>crypto.getRandomValues(new Uint32Array(1))[0]/2**32,n=[];for(let a=0;a+1<e.path.length;a+=2){const[o,l]=[2*Math.PI*t(),e.radius*Math.sqrt(t())],c=this.app.viewer.groundUnder(e.path[a]+l*Math.cos(o),e.path[a+1]+l*Math.sin(o));c&&n.every(h=>h.distanceTo(c)>=this.spacing)&&n.push(c)}const i=this.scattered,r=async()=>{for(const a of n)await this.putAt(i,a,2*Math.PI*t(),e.stroke)};return this.app.run(r()),!0}async compose(){const{document:e}=this.boxes;if(!e)throw new Error("Choose a model for boxes first");const t=this.jobs.freshName("placed",".json"),n=this.workflow.model.id;await En("labels/export",{file:e.file,format:"annotation",name:t,ground:n});const i=this.jobs.freshName("scene"),r=await this.jobs.runAndShow("compose",{annotation:t,primitives:this.workflow.set.id,nearest:1,name:i});this.workflow.world.set(r)}async writeTracks(){const{document:e}=this.boxes;if(!e)throw new Error("Choose a log for boxes first");const t=this.jobs.freshName("tracks",".csv"),n=await En("labels/export",{file:e.file,format:"tracks",name:t});return this.app.tell(`Written: ${n.path}, ${n.boxes} boxes`),t}async learnActors(){const e=await this.writeTracks();await this.jobs.runAndShow("actors",{log:this.boxes.document.file,boxes:e,name:this.jobs.freshName("actors")})}actions(){const e=t=>()=>{const{document:n}=this.boxes;n&&this.app.run(n.send(t?"undo":"redo",{},!1))};return[{key:"7",name:"boxes: undo",act:e(!0)},{key:"8",name:"boxes: redo",act:e(!1)},{key:"9",name:"boxes: label the points inside",act:()=>this.labelInside()}]}}const yo=4294967295,bo=[24,26,30],dg=[70,74,80],ug=[213,94,0],fg=[86,180,233],Eo=["measured","simulated","error"];async function pg(s,e,t,n){const i=t?.kind==="log"?{other:t.id}:t?{world:t.id,seed:n}:{},r=await bn(`range_image?${un({file:s,run:e,...i})}`),[a,o,l]=new Uint32Array(r,0,3),c=a*o,h={file:s,beside:t,width:a,height:o,row:new Uint32Array(c),measured:new Float32Array(c),other:l?new Float32Array(c):null},u=new Uint32Array(r,12),d=new Float32Array(r,12);for(let f=0;f<c;++f)h.row[f]=u[3*f],h.measured[f]=d[3*f+1],h.other&&(h.other[f]=d[3*f+2]);return h}function mg(s){const e=s.filter(t=>t>0).sort();return e.length>0?e[Math.floor(.98*(e.length-1))]:1}class gg{constructor(e,t,n){this.app=e,this.show=t,this.pick=n,this.scanSlider=Kt("Scan",[0,1,1],0,a=>this.choose(Math.round(a)));const i=()=>!this.view.hidden&&e.run(this.draw());this.logBox.addEventListener("change",()=>this.choose(0)),this.besideBox.addEventListener("change",i);const r=Ae("Range images","Show or hide the range images of the scan (/)",()=>this.toggle());e.section("Range images",L("label",{class:"row"},"Log",this.logBox),L("label",{class:"row"},"Beside it",this.besideBox),this.scanSlider.row,r),document.body.append(this.view),e.onApply.push(()=>this.repaint()),this.refresh()}app;show;pick;logBox=L("select",{"aria-label":"Log of the range image"});besideBox=L("select",{"aria-label":"Beside the range image"});scanSlider;view=L("section",{id:"images","aria-label":"Range images",hidden:""});crosses=[];image=null;map="";run=0;at=0;asked=0;refresh(){const e=(i,r)=>{const a=i.value;i.replaceChildren(...r),r.some(o=>o.value===a)&&(i.value=a)},t=i=>L("option",{value:`${i.id}`},i.name),n=[...this.app.of("model"),...this.app.of("scene")];e(this.logBox,this.app.of("log").map(t)),e(this.besideBox,[L("option",{value:""},"nothing"),...[...this.app.of("log"),...n].map(t)])}get runs(){return this.app.files.clouds.get(Number(this.logBox.value))?.octree.runs??[]}choose(e){this.run=e,this.view.hidden||this.app.run(this.draw())}goTo(e){const t=this.app.files.clouds.get(Number(this.logBox.value));if(this.view.hidden||!t)return;const n=e+t.octree.facts.first_time_s,i=Math.max(0,t.octree.runs.filter(r=>r.time<=n).length-1);i!==this.run&&(this.scanSlider.set(i),this.choose(i))}toggle(){this.view.hidden=!this.view.hidden,$e.dataset.images="",this.view.hidden||this.app.run(this.draw())}async draw(){if(this.logBox.value==="")throw new Error("There is no log");const e=++this.asked,t=Number(this.logBox.value),n=this.besideBox.value===""?null:this.app.files.file(Number(this.besideBox.value));await this.show(t),n?.kind==="log"&&await this.show(n.id),this.scanSlider.limits(0,Math.max(1,this.runs.length-1)),this.scanSlider.step(1),this.run=Math.min(this.run,this.runs.length-1);const i=await pg(t,this.run,n,this.app.list.seed);if(e!==this.asked)return;this.image=i,this.paint();const r=i.measured.filter(a=>a>0).length;$e.dataset.images=`${i.width} x ${i.height}, ${r} hits${i.other?", both":""}`}repaint(){this.image&&this.map!==this.app.state.map&&this.paint()}paint(){const e=this.image,{beside:t}=e;this.map=this.app.state.map;const n=this.runs[this.run],i=this.app.files.file(e.file).name;this.crosses.length=0;const r=mg(e.measured),a=`0 (dark) to ${r.toFixed(0)} m`,o={measured:`Measured: ${i}, scan ${n?.scan??0}; ${a}; black: no return`,simulated:`${t?.kind==="log"?"Beside it":"Simulated"}: ${t?.name??""}; ${a}`,error:"Error: 0 (dark) to 1 m and more; orange: a hit where none was measured; blue: a hit is missing"},l=e.other?Eo:Eo.slice(0,1);this.view.replaceChildren(L("div",{class:"head"},L("h2",{},"Range images"),Ae("×","Close the range images",()=>this.toggle())),...l.map(c=>this.figure(c,o[c],r)))}figure(e,t,n){const i=this.image,r=L("canvas",{width:`${i.width}`,height:`${i.height}`,tabindex:"0",role:"img","aria-label":`Range image, ${e}: arrows move, Enter picks the beam`}),a=r.getContext("2d"),o=a.createImageData(i.width,i.height),l=$r(this.app.state.map);for(let h=0;h<i.row.length;++h){const u=this.colour(e,h,n,l);o.data.set([u[0],u[1],u[2],255],4*h)}a.putImageData(o,0,0),r.addEventListener("click",h=>{const u=Math.floor(h.offsetX/r.clientWidth*i.width),d=Math.floor(h.offsetY/r.clientHeight*i.height);this.choosePixel(Math.min(d,i.height-1)*i.width+Math.min(u,i.width-1))}),r.addEventListener("keydown",h=>this.steer(h));const c=L("span",{class:"cross",hidden:""});return this.crosses.push(c),L("figure",{},L("div",{class:"image"},r,c),L("figcaption",{},t))}colour(e,t,n,i){const{row:r,measured:a,other:o}=this.image;if(r[t]===yo)return dg;const l=u=>{const d=4*Math.round(255*Math.min(1,Math.max(0,u)));return[i[d],i[d+1],i[d+2]]},c=e==="simulated"?o[t]:a[t];if(e!=="error")return c>0?l(c/n):bo;const h=o[t];return c===0&&h===0?bo:c===0?ug:h===0?fg:l(Math.sqrt(Math.abs(h-c)))}steer(e){const{width:t,height:n}=this.image,[i,r]=[this.at%t,Math.floor(this.at/t)],o={ArrowLeft:[-1,0],ArrowRight:[1,0],ArrowUp:[0,-1],ArrowDown:[0,1]}[e.key];if(o)this.at=Math.min(n-1,Math.max(0,r+o[1]))*t+(i+o[0]+t)%t,this.cross(this.at);else if(e.key==="Enter")this.choosePixel(this.at);else return;e.preventDefault(),e.stopPropagation()}choosePixel(e){this.at=e,this.cross(e);const t=this.image.row[e];t===yo?this.app.tell("No beam of the scan is at this pixel"):this.app.run(this.pick(this.image.file,t))}cross(e){const{width:t,height:n}=this.image;for(const i of this.crosses)i.hidden=e<0,i.style.left=`${100*(e%t+.5)/t}%`,i.style.top=`${100*(Math.floor(e/t)+.5)/n}%`}mark(e,t){if(!this.image||this.view.hidden||this.image.file!==e)return;const n=this.image.row.indexOf(t);n>=0&&(this.at=n),this.cross(n)}actions(){return[{key:"/",name:"range images of a scan",act:()=>this.toggle()}]}}const _g=["#details","#images","#library","#panel","header","#legend"],To=1.08;function vg(s){const e=s.getBoundingClientRect();let[t,n,i,r]=[e.left,e.top,e.right,e.bottom];for(const l of _g){const c=document.querySelector(l)?.getBoundingClientRect();if(!c||c.width===0||c.height===0||!(c.left<i&&c.right>t&&c.top<r&&c.bottom>n))continue;[{share:(r-n)*(c.left-t),cut:()=>i=c.left},{share:(r-n)*(i-c.right),cut:()=>t=c.right},{share:(i-t)*(c.top-n),cut:()=>r=c.top},{share:(i-t)*(r-c.bottom),cut:()=>n=c.bottom}].sort((d,f)=>f.share-d.share)[0].cut()}const a={left:t-e.left,top:n-e.top,width:i-t,height:r-n};return a.width>=120&&a.height>=120?a:{left:0,top:0,width:e.width,height:e.height}}function xg(s,e,t,n){const i=e.left+e.width/2-t/2,r=e.top+e.height/2-n/2;s.setViewOffset(t,n,-i,-r,t,n)}function Sg(s,e,t,n){const i=e.clone().cross(new D(0,0,1));i.lengthSq()<1e-9&&i.set(1,0,0),i.normalize();const r=i.clone().cross(e),a=s.getSize(new D).multiplyScalar(.5);let o=2/To;for(let l=0;l<8;++l){const c=a.clone().multiply(new D(l&1?1:-1,l&2?1:-1,l&4?1:-1)),h=c.dot(e);o=Math.max(o,Math.abs(c.dot(i))/t-h,Math.abs(c.dot(r))/n-h)}return o*To}const Ao=new D(0,0,1),Mg=["w","a","s","d","q","e"];class wg{constructor(e,t,n,i){this.camera=e,this.canvas=t,this.changed=n,this.clicked=i,e.up.copy(Ao),t.addEventListener("pointerdown",r=>this.down(r)),t.addEventListener("pointermove",r=>this.move(r)),t.addEventListener("pointerup",r=>this.up(r)),t.addEventListener("pointercancel",r=>this.pointers.delete(r.pointerId)),t.addEventListener("contextmenu",r=>r.preventDefault()),t.addEventListener("wheel",r=>{r.preventDefault(),this.used=!0,this.zoom(Math.exp(r.deltaY*.001))},{passive:!1}),window.addEventListener("blur",()=>this.keys.clear())}camera;canvas;changed;clicked;target=new D;used=!1;framed=!1;pointers=new Map;keys=new Set;moved=0;frame(e,t,n){const i=this.camera.position.clone().sub(this.target);i.lengthSq()<1e-9&&i.set(-.6,-1,.7),i.normalize(),e.getCenter(this.target),this.framed=!0,this.camera.position.copy(this.target).addScaledVector(i,Sg(e,i.clone().negate(),t,n)),this.apply()}lookFrom(e){const t=this.camera.position.distanceTo(this.target);this.camera.position.copy(this.target).addScaledVector(e.normalize(),t),this.apply()}set(e,t){this.framed=!1,this.camera.position.copy(e),this.target.copy(t),this.apply()}orbit(e,t){this.framed=!1;const n=this.camera.position.clone().sub(this.target),i=new hc().setFromVector3(new D(n.x,n.z,-n.y));i.theta-=e,i.phi=Math.min(Math.PI-.01,Math.max(.01,i.phi-t));const r=new D().setFromSpherical(i);this.camera.position.copy(this.target).add(new D(r.x,-r.z,r.y)),this.apply()}zoom(e){this.framed=!1;const t=this.camera.position.clone().sub(this.target).multiplyScalar(e);t.length()<.05||t.length()>1e6||(this.camera.position.copy(this.target).add(t),this.apply())}shift(e,t,n){this.framed=!1;const i=this.camera.position.distanceTo(this.target),r=this.target.clone().sub(this.camera.position).normalize(),a=r.clone().cross(Ao).normalize(),o=a.clone().cross(r),l=a.multiplyScalar(e*i).addScaledVector(o,t*i).addScaledVector(r,n*i);this.camera.position.add(l),this.target.add(l),this.apply()}keyDown(e){return Mg.includes(e)?(this.keys.add(e),!0):!1}keyUp(e){this.keys.delete(e)}fly(e){if(this.keys.size===0)return!1;const t=i=>Number(this.keys.has(i)),n=Math.min(e,.1)*.8;return this.shift((t("d")-t("a"))*n,(t("e")-t("q"))*n,(t("w")-t("s"))*n),!0}apply(){const e=this.camera.position.distanceTo(this.target);this.camera.near=Math.max(.01,e/500),this.camera.far=e*100+2e3,this.camera.lookAt(this.target),this.camera.updateProjectionMatrix(),this.camera.updateMatrixWorld(),this.changed()}down(e){this.used=!0,this.canvas.setPointerCapture(e.pointerId),this.canvas.focus(),this.pointers.set(e.pointerId,{x:e.clientX,y:e.clientY}),this.pointers.size===1?this.moved=0:this.moved=100}move(e){const t=this.pointers.get(e.pointerId);if(!t)return;const n=e.clientX-t.x,i=e.clientY-t.y;this.moved+=Math.abs(n)+Math.abs(i);const r=1/Math.max(1,this.canvas.clientHeight);if(this.pointers.size>=2){const a=[...this.pointers].find(([c])=>c!==e.pointerId)[1],o=Math.hypot(t.x-a.x,t.y-a.y),l=Math.hypot(e.clientX-a.x,e.clientY-a.y);o>1&&l>1&&this.zoom(o/l),this.shift(-n/2*r,i/2*r,0)}else e.buttons&2||e.shiftKey?this.shift(-n*r,i*r,0):this.moved>4&&this.orbit(4*n*r,4*i*r);this.pointers.set(e.pointerId,{x:e.clientX,y:e.clientY})}up(e){if(this.pointers.delete(e.pointerId)&&this.moved<=4&&e.button===0){const t=this.canvas.getBoundingClientRect();this.clicked(e.clientX-t.left,e.clientY-t.top)}}}const nn=11,yg=4294967295;class bg{constructor(e){this.drawn=e}drawn;targets=[];near=new Zt(nn,nn);add(e){return this.targets.push(e)-1}replace(e,t){this.targets[e]=t}pick(e,t,n){const{scene:i,clouds:r,worlds:a,unpickable:o}=this.drawn,l=i.background;i.background=null,o.forEach(M=>M.visible=!1),i.traverse(M=>this.withoutBlending(M));const c=e.camera.clone();c.layers.mask=Bs;const h=(nn-1)/2,{offsetX:u,offsetY:d}=e.camera.view??{offsetX:0,offsetY:0};c.setViewOffset(e.width,e.height,t-h+u,n-h+d,nn,nn);const f=new Kn().setFromProjectionMatrix(new Qe().multiplyMatrices(c.projectionMatrix,c.matrixWorldInverse));r.forEach(M=>M.cull(f)),a.forEach(M=>M.update(c,e.height,e.ellipsoids));const g=this.numbers(c,Rs.object),S=this.numbers(c,Rs.part);i.background=l,o.forEach(M=>M.visible=!0);const m=Eg(g,h),p=m<0?void 0:this.targets[g[m]];return p?this.whole(p,S[m],e,t,n):null}numbers(e,t){const{renderer:n,display:i}=this.drawn;i.uniforms.pass.value=t,n.setRenderTarget(this.near),n.setClearColor(16777215,1),n.clear(),n.render(this.drawn.scene,e);const r=new Uint8Array(4*nn*nn);return n.readRenderTargetPixels(this.near,0,0,nn,nn,r),n.setRenderTarget(null),i.uniforms.pass.value=Rs.picture,new Uint32Array(r.buffer)}withoutBlending(e){const t=e.material;t&&!Array.isArray(t)&&(t.blending=0)}whole(e,t,n,i,r){if(e.kind==="point")return{target:e,part:t,place:e.cloud.placeOf(t)};if(e.kind==="beam")return{target:e,part:t,place:null};if(e.part==="ellipsoid")return{target:e,part:t,place:e.world.centreOf(e.instance,t)};const a=kr(n,i,r).intersectObject(e.world.group,!0).find(o=>this.targets[o.object.userData.pick]===e);return{target:e,part:a?.faceIndex??0,place:a?.point??null}}}function Eg(s,e){let t=-1,n=1/0;return s.forEach((i,r)=>{if(i===yg)return;const a=Math.hypot(r%nn-e,Math.floor(r/nn)-e);a>=n||(n=a,t=r)}),t}function kr(s,e,t){const n=new ko;return n.setFromCamera(new Ye(e/s.width*2-1,1-t/s.height*2),s.camera),n}class Tg{constructor(e,t){this.canvas=e,this.renderer=new rp({canvas:e,antialias:!1,preserveDrawingBuffer:!0}),this.points=new Km(this.renderer,this.display),this.renderer.setPixelRatio(this.pixelRatio),this.scene.background=new Xe,this.scene.add(this.marks,this.overlays,this.points.quad);const{renderer:n,scene:i,display:r,clouds:a,worlds:o}=this;this.picker=new bg({renderer:n,scene:i,display:r,clouds:a,worlds:o,unpickable:[this.marks,this.overlays]}),this.navigation=new wg(this.camera,e,()=>{this.turned=performance.now(),this.draw()},(c,h)=>t(this.pick(c,h))),new ResizeObserver(()=>this.resize()).observe(e),this.resize();const l=c=>{requestAnimationFrame(l),this.navigation.fly((c-this.last)/1e3),this.last=c;const h=c-this.turned<250;(this.dirty||this.coarse&&!h)&&this.isDrawn()&&this.render(h)};requestAnimationFrame(l)}canvas;display=new lp;camera=new sn(60,1,.1,1e4);navigation;clouds=new Set;worlds=new Set;budget=2e6;ellipsoidBudget=4e4;onDrawn=null;insets=[];sides=null;overlays=new Ot;points;renderer;scene=new Xl;marks=new Ot;picker;dirty=!0;last=0;turned=-1/0;movingBudget=5e5;coarse=!1;drawn=0;soon=0;pictureMs=0;fence=null;free={left:0,top:0,width:1,height:1};get pixelRatio(){return this.points.software?1:Math.min(window.devicePixelRatio,2)}isDrawn(){if(!this.fence)return!0;const e=this.renderer.getContext();return e.clientWaitSync(this.fence,0,0)===e.TIMEOUT_EXPIRED?!1:(e.deleteSync(this.fence),this.fence=null,this.pictureMs=performance.now()-this.drawn,!0)}draw(){this.dirty=!0}drawSoon(){if(this.soon!==0)return;const e=Math.min(3e3,Math.max(100,3*this.pictureMs));this.soon=window.setTimeout(()=>{this.soon=0,this.draw()},e)}setBackground(e){this.scene.background=new Xe(e),this.draw()}target(e){return this.picker.add(e)}replaceTarget(e,t){this.picker.replace(e,t)}addCloud(e){this.clouds.add(e),this.scene.add(e.group),this.draw()}removeCloud(e){this.clouds.delete(e),this.scene.remove(e.group),e.dispose(),this.draw()}addWorld(e){this.worlds.add(e),this.scene.add(e.group),this.draw()}add(e){this.scene.add(e),this.draw()}remove(e){e.removeFromParent(),this.draw()}mark(...e){this.marks.clear(),e.forEach(t=>this.marks.add(t)),this.draw()}measured(e,t){const n=new Si({color:13400487,depthTest:!1});return new Hs(new ht().setFromPoints([e,t]),n)}get isEmpty(){return![...this.clouds,...this.worlds].some(e=>e.group.visible)}bounds(){const e=new vt;for(const t of this.clouds)t.group.visible&&e.union(t.core);for(const t of this.worlds)t.group.visible&&e.union(t.bounds);return e.isEmpty()?new vt(new D(-10,-10,0),new D(10,10,5)):e}frameAll(){const t=[...this.clouds].filter(a=>a.group.visible).reduce((a,o)=>a.union(o.core),new vt),n=this.bounds(),{min:i,max:r}=t.isEmpty()?n:t;this.display.uniforms.heights.value.set(i.z,r.z),this.frameBox(n)}frameBox(e){this.centre();const{width:t,height:n}=this.view,i=Math.tan(this.camera.fov*Math.PI/360),r=i*Math.min(this.free.width,t)/n;this.navigation.frame(e,r,i*this.free.height/n)}lookFrom(e){const{framed:t}=this.navigation;this.navigation.lookFrom(e),t&&this.frameAll()}centre(){const{width:e,height:t}=this.view;this.free=vg(this.canvas),this.sides&&(this.free={left:0,top:0,width:e,height:t}),xg(this.camera,this.free,e,t)}get middle(){return[this.free.left+this.free.width/2,this.free.top+this.free.height/2]}get drawnPoints(){let e=0;for(const t of this.clouds)e+=t.group.visible?t.drawnPoints:0;return e}get loading(){return this.dirty||this.coarse||this.soon!==0||[...this.clouds].some(e=>e.group.visible&&e.loading)}resize(){const e=Math.max(1,this.canvas.clientWidth),t=Math.max(1,this.canvas.clientHeight);this.renderer.setSize(e,t,!1),this.camera.aspect=this.view.width/t,this.centre(),this.draw()}render(e=!1){this.dirty=!1,this.drawn=performance.now(),e&&(this.movingBudget*=this.pictureMs>50?.85:this.pictureMs<35?1.1:1);const t=this.points.splats?3e5:1e5;this.movingBudget=Math.min(this.budget,Math.max(t,this.movingBudget)),this.coarse=e&&this.movingBudget<this.budget;const n=this.coarse?this.movingBudget:this.budget,i=[...this.clouds].filter(l=>l.group.visible);for(const l of i)l.update(this.camera,this.canvas.clientHeight,n/i.length,this.budget/i.length);const r=this.ellipsoidBudget*(this.coarse?this.movingBudget/this.budget:1),a=[...this.worlds].filter(l=>l.group.visible);for(const l of a)l.update(this.camera,this.canvas.clientHeight,r/a.length);this.renderParts(i),this.insets.forEach(l=>this.renderInset(l));const o=this.renderer.getContext();this.fence&&o.deleteSync(this.fence),this.fence=o.fenceSync(o.SYNC_GPU_COMMANDS_COMPLETE,0),o.flush(),this.onDrawn?.()}get view(){const{clientWidth:e,clientHeight:t}=this.canvas;return{camera:this.camera,width:al(this.sides,e),height:t,ellipsoids:this.ellipsoidBudget}}get groups(){return[...this.clouds,...this.worlds].map(e=>e.group)}beside(e){const t=[...this.worlds];return t.some(n=>n.group===e)?t.filter(n=>n.moves).map(n=>n.group):[]}renderParts(e){const{renderer:t,scene:n,camera:i,points:r}=this,{clientWidth:a,clientHeight:o}=this.canvas,l=t.getPixelRatio(),c=this.sides?.mode==="split",h=xp(this.sides,a).map(u=>{const d=e.filter(g=>!u.side||u.side===g.group),f=c?u.from:0;return{...u,shown:d,left:f,ends:[u.from,u.from+u.width].map(g=>Math.round(g*l))}});r.begin(e[0]?.size??1,this.isDeep,n.background);for(const{side:u,shown:d,left:f,ends:g}of h){const S={left:f*l,width:this.view.width*l,from:g[0],to:g[1]};e.length>0&&br(this.groups,u,this.beside(u),()=>r.add(n,i,d,S))}r.finish(i),t.setScissorTest(h.length>1);for(const{side:u,from:d,width:f,left:g}of h)t.setScissor(d,0,f,o),t.setViewport(g,0,this.view.width,o),br(this.groups,u,this.beside(u),()=>r.show(n,i));t.setScissorTest(!1),t.setViewport(0,0,a,o)}get isDeep(){const e=[this.points.quad,...[...this.clouds].map(n=>n.group)];return this.scene.children.filter(n=>n.visible&&!e.includes(n)&&n!==this.marks&&n!==this.overlays).length+this.marks.children.length>0||this.overlays.children.some(n=>n.visible)}renderInset({camera:e,element:t}){const n=t.getBoundingClientRect(),i=n.left-this.canvas.getBoundingClientRect().left,r=this.canvas.clientHeight-n.bottom;e.layers.mask=Bs,this.renderer.setViewport(i,r,n.width,n.height),this.renderer.setScissor(i,r,n.width,n.height),this.renderer.setScissorTest(!0),this.renderer.render(this.scene,e),this.renderer.setScissorTest(!1),this.renderer.setViewport(0,0,this.canvas.clientWidth,this.canvas.clientHeight)}groundAt(e,t){const n=new ko(new D(e,t,1e5),new D(0,0,-1));return this.groundMet(n)?.z??null}groundUnder(e,t){return this.groundMet(kr(this.view,Cs(this.sides,this.canvas.clientWidth,e).x,t))}placeUnder(e,t,n){const{ray:i}=kr(this.view,Cs(this.sides,this.canvas.clientWidth,e).x,t);return i.intersectPlane(new wn(new D(0,0,1),-n),new D)}groundMet(e){const t=[...this.worlds].filter(n=>n.group.visible).map(n=>n.group);return e.intersectObjects(t,!0)[0]?.point??null}picture(){return this.render(),new Promise((e,t)=>{this.canvas.toBlob(n=>n?e(n):t(new Error("no picture")),"image/png")})}pick(e,t){const{x:n,side:i}=Cs(this.sides,this.canvas.clientWidth,e),r=br(this.groups,i,this.beside(i),()=>this.picker.pick(this.view,n,t));return this.draw(),r}}function Ag(s){const e=s.unit?`${s.name}, ${s.unit}`:s.name,t=(i,...r)=>L("label",{class:`row ${i}`,title:s.help},...r);if(s.type==="bool"){const i=L("input",{type:"checkbox"});return{row:t("check",i,e),given:()=>i.checked?"true":""}}if(s.choices.length>0){const i=s.choices.includes(s.default)?s.choices:[s.default,...s.choices],r=L("select",{"aria-label":e},...i.map(a=>L("option",{value:a},a)));return r.value=s.default,{row:t("",e,r),given:()=>r.value===s.default?"":r.value}}if(s.type==="str"||s.type==="Sequence[str]"){const i=L("input",{type:"text",placeholder:s.value});return{row:t("",e,i),given:()=>i.value.trim()}}const n=L("input",{type:"number",placeholder:s.default,step:s.type==="int"?"1":"any"});return s.least!==null&&(n.min=`${s.least}`),s.most!==null&&(n.max=`${s.most}`),{row:t("",e,n),given:()=>{if(!n.checkValidity())throw new Error(`${s.name}: ${n.validationMessage}`);return n.value}}}class Rg{box;controls=new Map;constructor(e,t){this.box=L("details",{},L("summary",{},`Options of ${e}`));const n=new Map([["",this.box]]);for(const i of t){if(!n.has(i.group)){const a=L("details",{},L("summary",{},i.group));n.set(i.group,a),this.box.append(a)}const r=Ag(i);this.controls.set(i.name.replaceAll("-","_"),r),n.get(i.group).append(r.row)}}given(){const e=[...this.controls].map(([t,{given:n}])=>[t,n()]);return Object.fromEntries(e.filter(([,t])=>t!==""))}}class $n{constructor(e,t,n,i=""){this.app=e,this.kinds=n,this.none=i,this.row=L("label",{class:"row"},t,this.box),this.refresh()}app;kinds;none;box=L("select");row;refresh(){const e=this.box.value,t=this.kinds.flatMap(n=>this.app.of(n));this.box.replaceChildren(...this.none?[L("option",{value:""},this.none)]:[],...t.map(n=>L("option",{value:`${n.id}`},n.name))),t.some(n=>`${n.id}`===e)&&(this.box.value=e)}get id(){if(this.box.value==="")throw new Error(`There is no ${this.kinds.join(" or ")}`);return Number(this.box.value)}get chosen(){return this.box.value===""?void 0:Number(this.box.value)}set(e){this.refresh(),this.box.value=`${e}`}}class Cg{constructor(e,t,n,i){this.app=e,this.labeller=t,this.jobs=n,this.menu=i,this.log=new $n(e,"Log",["log"]),this.model=new $n(e,"Model",["model"]),this.set=new $n(e,"Primitives",["primitives"]),this.world=new $n(e,"World",["scene","model"]),this.simulated=new $n(e,"Simulated",["log"]),this.scored=new $n(e,"Model of the simulation",["scene","model"],"none"),this.train=new $n(e,"Training log",["log"],"none"),this.labelFile.addEventListener("focus",()=>e.run(this.listLabelFiles()));const r=(a,o,l)=>Ae(a,o,()=>e.run(l()));e.section("From labels to scans",...[this.log,this.model,this.set,this.world,this.simulated].map(a=>a.row),L("div",{class:"buttons"},r("Propose","Let segment label what has no class yet",()=>this.propose()),r("Carry on","Carry the labels of a scan to the next one",()=>this.carry()),r("Labelled log","Write the log with its labels",()=>this.writeLog()),r(".label file","Write labels in the numbers of SemanticKITTI",()=>this.writeLabels()),r("Fit","Fit a model to the log",()=>this.fit()),r("Extract","Cut primitives out of the model along the labelled log",()=>this.extract()),r("Annotate","Write the objects of the labelled log as an annotation on the model",()=>this.annotate()),r("Compose again","Compose a scene of that annotation with the chosen primitives",()=>this.compose()),r("Simulate","Simulate the beams of the log in the world",()=>this.simulate()),r("Score","Compare the simulated log with the log",()=>this.score())),this.formBox,L("label",{class:"row"},"Labels",this.labelFile),L("label",{class:"row"},"in numbers of",this.labelSet),L("div",{class:"buttons"},r("Import","Take labels over from this file of the folder for labels",()=>this.importLabels()))),n.onFiles.push(()=>{[this.log,this.model,this.set,this.world,this.simulated,this.scored,this.train].forEach(a=>a.refresh()),e.run(this.listLabelFiles()),t.listLogs()}),e.run(this.listLabelFiles()),e.run(this.listOptions())}app;labeller;jobs;menu;log;model;set;world;simulated;scored;train;labelFile=L("select",{"aria-label":"File of labels"});labelSet=L("select",{"aria-label":"Numbers of the file"},L("option",{value:""},"as the file says"));forms=new Map;formBox=L("div");annotation="";async listOptions(){for(const[e,t]of Object.entries(await ut("jobs/options"))){this.forms.set(e,new Rg(e,t));const n=t.find(i=>e==="segment"&&i.name==="label-set")?.choices??[];this.labelSet.append(...n.map(i=>L("option",{value:i},i)))}this.forms.get("score")?.box.append(this.scored.row,this.train.row),this.formBox.replaceChildren(...[...this.forms.values()].map(e=>e.box))}given(e){return this.forms.get(e)?.given()??{}}async listLabelFiles(){const{names:e}=await ut("labels/files"),t=this.labelFile.value;this.labelFile.replaceChildren(...e.map(n=>L("option",{value:n},n))),e.includes(t)&&(this.labelFile.value=t)}async importLabels(){const e=this.labelled(),[t,n]=[this.labelFile.value,this.labelSet.value];if(t==="")throw new Error("There is no file of labels in the folder for labels");const i=await e.send("import",{name:t,set:n,...this.labeller.conditions()},!0);this.app.tell(`${i.rows} points have other labels now, those of ${t}`)}async annotate(){const e=this.jobs.freshName(`${this.stem(this.log)}-site`,".json");await this.jobs.run("annotate",{log:this.log.id,ground:this.model.id,name:e}),this.annotation=e,this.app.tell(`Written: ${e}`)}async compose(){if(this.annotation==="")throw new Error("Annotate a labelled log first");const e=this.jobs.freshName("scene"),t={...this.given("compose"),annotation:this.annotation,primitives:this.set.id,ground:this.model.id,name:e};this.world.set(await this.jobs.runAndShow("compose",t))}async score(){const e=this.jobs.freshName(`${this.stem(this.simulated)}-score`,".json"),t={real:this.log.id,simulated:this.simulated.id,model:this.scored.chosen,train:this.train.chosen};await this.jobs.runAndShow("score",{...this.given("score"),...t,name:e})}showFile(e){return this.menu.toggle(this.app.files.file(e),!0)}stem(e){return this.app.files.file(e.id).name.replace(/\.[a-z]+$/,"").replace(/^.*\//,"")}labelled(){const{labelled:e}=this.labeller;if(!e?.state)throw new Error("Choose a log to label first");return e}async propose(){const e=this.labelled(),t=this.app.files.file(e.file).name.replace(/\.[a-z]+$/,""),n=this.jobs.freshName(`${t}-proposal`,".ply");await this.jobs.run("segment",{...this.given("segment"),log:e.file,name:n});const i=await e.send("import",{name:n,unlabelled:1,...this.labeller.conditions()},!0);this.app.tell(`${i.rows} points have the label that segment proposes`)}async carry(){const e=this.labelled(),t=[...new Set(e.cloud.octree.runs.map(a=>a.scan))],n=prompt(`Scan from which labels are carried to the next (${t[0]} to ${t.at(-2)??t[0]})`,`${t[0]}`);if(n===null)return;const i=t[t.indexOf(Number(n))+1];if(i===void 0)throw new Error("There is no scan after it");const r=await e.send("carry",{from_scan:Number(n),scan:i,radius:.3},!0);this.app.tell(`${r.rows} points of scan ${i} have the label of the nearest point of scan ${n}`)}async writeLog(){const e=this.labelled(),t=this.app.files.file(e.file).name.replace(/\.[a-z]+$/,""),n=this.jobs.freshName(`${t}-labelled`,".ply"),i=await En("labels/export",{file:e.file,format:"log",name:n});await this.jobs.newFiles(),this.log.set(i.file),this.app.tell(`Written: ${i.path}`)}async writeLabels(){const e=this.labelled(),t=this.app.files.file(e.file).name.replace(/\.[a-z]+$/,""),n=this.jobs.freshName(t,".label"),i=await En("labels/export",{file:e.file,format:"label",name:n}),r=i.without_number?`; ${i.without_number} points have a class that the set does not know`:"";this.app.tell(`Written: ${i.path}${r}`)}async fit(){const e=this.jobs.freshName(`${this.stem(this.log)}-model`),t=this.log.id;this.model.set(await this.jobs.runAndShow("fit",{...this.given("fit"),log:t,name:e})),this.train.set(t)}async extract(){const e=this.jobs.freshName(`${this.stem(this.log)}-primitives`);this.set.set(await this.jobs.runAndShow("extract",{...this.given("extract"),model:this.model.id,log:this.log.id,name:e}))}async simulate(e){const t=this.jobs.freshName(`${this.stem(this.world)}-scan`,".ply"),n=this.world.id;this.simulated.set(await this.jobs.runAndShow("simulate",{...this.given("simulate"),world:n,like:this.log.id,actors:e,name:t})),e===void 0&&this.scored.set(n)}}const Bt=Jm(location.hash),Yt=new Tg(zt("view"),s=>{yi.pick(s)}),mn=await ut("files"),Tn=new pm(mn.files,Yt,(s,e)=>{const t=zt("status");t.textContent?.startsWith(e)&&(t.textContent=s)}),Jr=new Set(Bt.shown??mn.files.filter(s=>s.kind!=="score").slice(0,2).map(s=>s.id));Bt.edits??=mn.edits??null;Bt.edits&&!Bt.shown&&Jr.add(Bt.edits.file);const ft=new Tp(mn,Bt,Yt,Tn,Jr),yi=new ag(ft),Et=new ng(ft,yi.actions);Tn.onPreview=()=>gl();const _i=mn.labels?new Tm(ft,Et):null,ml=new Ep(ft,s=>Et.toggle(Tn.file(s),!0),s=>Et.pointMode.set(s)),Ks=new gg(ft,s=>Et.toggle(Tn.file(s),!0),(s,e)=>yi.showBeam(s,e));yi.onBeam.push((s,e)=>Ks.mark(s,e));Et.time.onTime.push(s=>Ks.goTo(s));const vi=mn.jobs?new gm(ft,Et):null,Gs=_i&&vi?new Cg(ft,_i,vi,Et):null,Pg=Gs?new hg(ft,_i,vi,Gs,Et.time):null,Lg=new bp(ft,Et,vi,Gs&&(s=>Gs.simulate(s))),Dg=new Nm(ft,Et,vi);vi?.onFiles.push(()=>ml.refresh(),()=>Ks.refresh());_i?.onChange.push(()=>Et.legend.show());const Ng=[..._p(ft,Et,yi),...Et.time.actions(),...Ks.actions(),...ml.actions(),...Lg.actions(),...Dg.actions(),..._i?.actions()??[],...Pg?.actions()??[]];vp(ft,yi,Ng);window.matchMedia("(prefers-color-scheme: light)").addEventListener("change",()=>ft.apply());Yt.onDrawn=()=>{const s=Yt.drawnPoints;$e.dataset.points=String(s),$e.dataset.state=Yt.loading||Tn.loading||_i?.labelled?.loading?"loading":"ready",$e.dataset.drawer=Yt.points.splats?"processor":"graphics card",$e.dataset.eye=Yt.camera.position.toArray().map(t=>t.toFixed(3)).join(" ");const e=[...Yt.clouds].map(t=>t.error).find(Boolean);e&&ft.fail(e),zt("tools").dataset.points=s>0?`${(s/1e6).toFixed(2)} M points`:"",Et.keepLink()};function gl(){if(Yt.navigation.used)return ft.apply();if(ft.frame(),!Bt.eye||!Bt.target||!Tn.origin)return;const s=e=>new D(...e).sub(Tn.origin);Yt.navigation.set(s(Bt.eye),s(Bt.target))}const _l=document.querySelector("header"),vl=()=>$e.style.setProperty("--head",`${Math.ceil(_l.getBoundingClientRect().bottom)+8}px`);new ResizeObserver(vl).observe(_l);vl();Kr(window.innerWidth>700);ft.apply();for(const s of mn.files)Jr.has(s.id)&&await Et.toggle(s,!0).catch(e=>ft.fail(e));const Fg=mn.files.every(s=>s.kind==="score");Fg&&mn.files[0]&&await Et.toggle(mn.files[0],!0).catch(s=>ft.fail(s));gl();Bt.eye&&Tn.origin&&(Bt.slice.at-=Tn.origin[Bt.slice.axis],Et.sliceAt.set(Bt.slice.at));ft.apply();Et.restoring=!1;$e.dataset.opened="yes";ft.panel.append(Ae("Keys","Keys (?)",()=>zt("help").showModal()));Yt.canvas.focus();Yt.draw();
